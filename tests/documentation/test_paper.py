"""The page about the paper names every equation and figure of it, and only what is there."""

import re
from pathlib import Path

import matplotlib.pyplot as plt
import pytest
import yaml

from docs.generator.paper import BLOCK, rendered
from hypernode.config.loading import load_config
from hypernode.config.presets import presets
from hypernode.figures.render import compose
from hypernode.pipeline.shown import matching_runs, shown_runs
from hypernode.tables.columns import COLUMNS
from tests.figures.data import figure_input
from tests.tables.files import evaluation, rows_of, summary

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/paper.md").read_text()
#: Labels in the source of the paper.
EQUATIONS = (
    *("eq:equilibrium", "NODE_potential", "eq_strain energy density function_general", "hyper-network"),
    *("Node_constitutive_predicting", "eq_training_FDM_Fint", "pre-training1", "pre-training1-3", "pre-training1-6"),
    *("main_loss_function", "eq:SNR"),
)
FIGURES = (
    *("fig_summary", "p_example", "anisotropy_example", "noise_example", "experimental_example"),
    *("ablation_F_int", "ablation_NODE", "ablation_hyper", "detailed_results"),
)


@pytest.fixture(scope="module")
def config():
    return load_config(ROOT / "config/config.yaml")


@pytest.fixture(scope="module")
def configurations(config):
    """File of each configuration that the page may name -> the configuration."""
    return {"config/config.yaml": config, "config/ablations.yaml": load_config(ROOT / "config/ablations.yaml")}


def rows(heading):
    section = PAGE.split(f"## {heading}\n")[1].split("\n## ")[0]
    return [re.split(r" \| ", line.strip("| ")) for line in section.splitlines() if line.startswith("| `")]


@pytest.mark.parametrize(("heading", "labels"), [("Equations", EQUATIONS), ("Figures", FIGURES)])
def test_every_label_of_the_paper_has_a_row(heading, labels):
    assert [row[0].strip("`") for row in rows(heading)] == list(labels)


def test_every_figure_and_table_that_a_row_names_is_drawn_by_the_default_configuration(config):
    figures, tables = set(), set()
    for row in rows("Figures"):
        figures |= set(re.findall(r"`(\w+)`", re.sub(r"table `\w+`", "", row[2])))
        tables |= set(re.findall(r"table `(\w+)`", row[2]))
    assert len(figures) > len(FIGURES) and figures <= set(config.figures) and tables <= set(config.tables)


def test_every_module_that_is_named_is_there():
    named = re.findall(r"`(\w+/\w+\.py)`", PAGE)
    assert len(named) > 8 and not [name for name in named if not (ROOT / "src/hypernode" / name).is_file()]


def test_the_published_method_runs_on_every_sheet_of_the_paper(config):
    published = {
        name for name, case in config.cases.items() if {"paper_as_published", "published_40"} & {*case.methods}
    }
    noisy = {"ring", "ring_low", "ring_high", "ring_low_twice", "ring_low_thrice", "ring_low_x", "ring_low_xy"}
    assert published >= {"P_soft", "X", "X_published"} | noisy
    assert set(presets()) >= {"paper", "paper_as_published", "hypernode"}


def test_further_ablations_are_of_the_same_sheets_and_make_runs_them(config):
    """A case of one name is one sheet: both configurations write into one folder of results."""
    further = load_config(ROOT / "config/ablations.yaml")
    shared = further.cases.keys() & config.cases.keys()
    assert len(shared) > 3
    for name in shared:
        case = further.cases[name]
        assert case.model_copy(update={"methods": [], "unseen_loads": []}) == config.cases[name].model_copy(
            update={"methods": [], "unseen_loads": []}
        )
        used = yaml.safe_dump(further.materials[case.matrix].model_dump(mode="json"))
        assert used == yaml.safe_dump(config.materials[case.matrix].model_dump(mode="json"))
    assert "config/ablations.yaml" in (ROOT / "Makefile").read_text().split("\nablations:")[1].split("\n\n")[0]


def lettered(text):
    """Letters of panels that a text names one by one, or as a range."""
    single = set(re.findall(r"\(([a-f])\)", text))
    ranges = re.findall(r"\(([a-f])\) to \(([a-f])\)", text)
    return single | {chr(code) for first, last in ranges for code in range(ord(first), ord(last) + 1)}


def drawn_letters(config, name):
    """Letters that a figure has on its panels, or on its rows."""
    figure = config.figures[name]
    if figure.kind == "comparison":
        return lettered(" ".join(run.label for run in shown_runs(figure)))
    titles = [axes.get_title(loc="left") for axes in compose(*figure_input(figure.kind, "pass")).axes]
    return lettered(" ".join(title for title in titles if title.startswith("(")))


def test_every_panel_of_a_figure_is_drawn_under_its_letter_or_said_to_be_elsewhere(config):
    for row in rows("Figures"):
        figures = re.findall(r"`(\w+)`", re.sub(r"table `\w+`", "", row[2]))
        drawn = set().union(*(drawn_letters(config, name) for name in figures)) | lettered(row[2])
        assert lettered(row[1]) <= drawn, row[0]
    plt.close("all")


def claims():
    section = PAGE.split("## Claims\n")[1].split("\n<!-- table")[0].split("\n## ")[0]
    return [re.split(r" \| ", line.strip("| ")) for line in section.splitlines() if line.startswith("| ")][1:]


def test_every_claim_names_what_shows_it_and_all_of_that_exists(configurations):
    default = configurations["config/config.yaml"]
    assert len(claims()) > 6
    for claim, _, evidence in claims():
        named = 0
        for part in evidence.split("; "):
            of = re.search(r" of `(config/\w+\.yaml)`$", part)
            config = configurations[of[1]] if of else default
            section = {"figure": config.figures, "table": config.tables}
            words = re.match(r"(figure|table)s? (.*)", part.replace(of[0], "") if of else part)
            for name in re.findall(r"`(\w+)`", words[2]) if words else ():
                assert name in section[words[1]], f"{claim}: {part}"
                named += 1
            for link in re.findall(r"\]\(([^)]+)\)", part):
                assert (ROOT / "docs" / link).is_file(), f"{claim}: {link}"
                named += 1
        assert named, claim


def test_rows_of_rendered_tables_are_runs_and_columns_of_their_configuration(configurations):
    """Where this fails: ``python -m docs.generator.paper RESULTS``."""
    blocks = list(BLOCK.finditer(PAGE))
    assert {block["name"] for block in blocks} == {"paper", "sweep"}
    for block in blocks:
        config = configurations[block["file"]]
        table = config.tables[block["name"]]
        runs = set(matching_runs(config, table.runs, config.cases))
        lines = rows_of(block["body"]) if "\n|" in block["body"] else []
        for cells in lines[1:]:
            assert tuple(cell.replace("\\", "") for cell in cells[:2]) in runs
        heads = [COLUMNS["runs"][name].header(name) for name in table.columns]
        assert not lines or lines[0][2 : 2 + len(heads)] == heads
        assert lines or "Not run: " in block["body"]


def test_a_table_is_rendered_from_a_run_and_names_what_was_not_run(tmp_path, configurations):
    evaluation(tmp_path, "X_published", "published_40", summary(0.0691, dice=0.943))
    page, results = (
        "before\n<!-- table sweep of config/ablations.yaml -->\nold\n<!-- end of table -->\n",
        tmp_path / "results",
    )
    text = rendered(page, results, configurations.__getitem__)
    row = rows_of(text)[1]
    assert row[:3] == [r"X\_published", r"published\_40", "6.91"] and row[5] == "0.943"
    assert text.startswith("before") and "old" not in text
    whole = len(configurations["config/ablations.yaml"].cases["ring_swept"].methods)
    assert f"`ring_swept`, all {whole}" in text and "`X_published`: `published_pretrained`, `published_muon`" in text
    assert rendered(text, results, configurations.__getitem__) == text
    with pytest.raises(ValueError, match=r"tables\.timing"):
        rendered(page.replace("sweep of config/ablations", "timing of config/config"), results, configurations.get)
