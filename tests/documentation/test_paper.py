"""The page about the paper names every equation and figure of it, and only what is there."""

import re
from pathlib import Path

import pytest
import yaml

from hypernode.config.loading import load_config
from hypernode.config.presets import presets

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
