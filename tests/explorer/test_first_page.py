"""The page that results are entered by: every run with its verdict, every link leads somewhere, nothing is loaded."""

import gc
import json
import re
import weakref
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from hypernode.config.loading import load_config
from hypernode.evaluation.level_budget import INPUTS, SHARE, LevelBudget, Part, table
from hypernode.explorer.facts import FACTS
from hypernode.explorer.first_page import TOPICS, first_page
from hypernode.pipeline.shown import figure_runs, first_page_settings, rules_by_topic
from tests.evaluation.files import square_mesh
from tests.explorer.browser import chromium
from tests.explorer.files import evaluation

ROOT = Path(__file__).resolve().parents[2]
LEVELS = {"good": "pass", "doubtful": "warn", "wrong<&": "fail"}
SETTINGS = {
    "configuration": ["small.yaml"],
    "cases": {"half": ("stiff in soft, equibiaxial", list(LEVELS))},
    "figures": {"halves": ("identification", ["half/good"])},
    "tables": ["summary"],
    "explorers": ["half/good"],
    "rules": {"evaluation": ["evaluation", "validation"], "forward": ["forward"]},
}


class Parsed(HTMLParser):
    """Links, ids, and the cells of every row of a table that belongs to a body."""

    def __init__(self, text):
        super().__init__()
        self.links, self.ids, self.rows, self._words = [], set(), [], None
        self.tags = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.tags.append(tag)
        self.links += [attrs["href"]] if tag == "a" else []
        self.ids |= {attrs["id"]} if "id" in attrs else set()
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th") and self.rows:
            self.rows[-1].append("")
            self._words = True

    def handle_endtag(self, tag):
        if tag in ("td", "th"):
            self._words = None

    def handle_data(self, data):
        if self._words:
            self.rows[-1][-1] += data


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A results folder with the page and everything that its settings promise."""
    results = tmp_path_factory.mktemp("results")
    mesh = square_mesh(2)
    runs = [evaluation(mesh, level, method) for method, level in LEVELS.items()]
    text = first_page(runs, {"abc123": 3}, SETTINGS)
    (results / "index.html").write_text(text, encoding="utf-8")
    promised = ["half/good/explorer.html", "ro-crate-metadata.json"]
    promised += [f"figures/halves.{form}" for form in ("png", "pdf")]
    promised += [f"tables/summary.{form}" for form in ("md", "csv", "tex")]
    for name in promised:
        (results / name).parent.mkdir(parents=True, exist_ok=True)
        (results / name).write_text("", encoding="utf-8")
    return results


def test_every_link_leads_to_a_file_of_the_results_and_all_of_them_are_linked(folder):
    page = Parsed((folder / "index.html").read_text(encoding="utf-8"))
    inside = [link[1:] for link in page.links if link.startswith("#")]
    files = {link for link in page.links if not link.startswith("#")}
    assert set(inside) <= page.ids
    there = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert files == there - {"index.html"}


def test_every_run_is_there_with_its_verdict_and_its_reason_and_those_that_fail_come_first(folder):
    page = Parsed((folder / "index.html").read_text(encoding="utf-8"))
    verdicts = [row for row in page.rows if row[0] in ("pass", "warn", "fail")]
    assert [row[:2] for row in verdicts] == [["fail", "half/wrong<&"], ["warn", "half/doubtful"], ["pass", "half/good"]]
    assert verdicts[0][2].startswith("The misfit of displacements over their noise is 3.21")
    numbers = [row for row in page.rows if row[0].startswith("half/")]
    assert len(numbers) == 3 and all(len(row) == 1 + len(FACTS) == 11 for row in numbers)
    assert "5.00" in numbers[0], "the spread in per cent"


def test_it_says_what_was_run_and_loads_nothing(folder):
    text = (folder / "index.html").read_text(encoding="utf-8")
    for words in ("3 runs of 1 case:", "small.yaml", "abc123", "stiff in soft, equibiaxial", "1 pass, 1 warn, 1 fail"):
        assert words in text
    assert not {"script", "img", "iframe", "object"} & set(Parsed(text).tags)
    assert "http" not in re.sub(r"http-equiv", "", text)
    assert text.index("The sheet") < text.index("How good it is"), "topics stand in the order in which results are made"


def test_where_a_law_fails_only_cells_that_the_criterion_counts_are_drawn_and_no_run_is_kept():
    mesh, alive = square_mesh(2), []

    def runs():
        for method, counted in (("good", 0), ("doubtful", 1)):
            each = evaluation(mesh, "pass", method)
            cells = (np.arange(4) < counted).astype(np.int8)
            each = each.assign(refuted=("cell", cells), refuted_by=("cell", np.ones(4)))
            alive.append(weakref.ref(each))
            yield each

    text = first_page(runs(), {"abc123": 2}, SETTINGS)
    assert "half/doubtful: 25 % of the sheet" in text and text.count("<figure>") == 1
    gc.collect()
    assert not any(each() for each in alive)


def test_the_budget_of_a_level_stands_on_the_page_with_a_star_where_the_test_told():
    mesh = square_mesh(2)
    parts = (
        Part("zero", 0.08, 0.02, 0.03, told_by="forces"),
        Part.stated("thickness", 0.04),
        Part.found(SHARE, 0.0, "field"),
    )
    told = evaluation(mesh).assign_attrs(level_budget=json.dumps(table(LevelBudget(parts, 1.0))))
    text = first_page([told, evaluation(mesh, method="none")], {"abc123": 2}, SETTINGS)
    rows = [row for row in Parsed(text[text.index('id="budget"') - 20 :]).rows if row[0] in ("run", "half/m")]
    assert dict(zip(*rows[:2], strict=True)) == {
        **dict.fromkeys(INPUTS, ""),
        **{"run": "half/m", "level": "5 %", "zero": "3 % *", "thickness": "4 %", SHARE: "0 %"},
    }
    assert 'id="budget"' not in first_page([evaluation(mesh)], {"abc123": 1}, SETTINGS)


def test_rules_of_the_workflow_all_have_a_topic_and_the_configuration_all_its_figures():
    rules = rules_by_topic(sorted(ROOT.glob("workflow/rules/*.smk")))
    scripts = {path.stem for path in (ROOT / "workflow/scripts").glob("*.py")}
    assert {name for names in rules.values() for name in names} >= scripts
    assert set(rules) == set(TOPICS)
    config = load_config(ROOT / "config/smoke.yaml")
    settings = first_page_settings(config, list(config.cases), ["smoke.yaml"], rules)
    assert settings["figures"].keys() == figure_runs(config, list(config.cases)).keys()
    assert set(settings["cases"]) == set(config.cases)


def test_all_that_the_report_shows_has_a_caption():
    """Of every kind of figure and table that a configuration may ask for the caption says something of its own."""
    for file in (ROOT / "workflow/rules").glob("*.smk"):
        text = file.read_text()
        captions = re.findall(r'caption="\.\./(report/\w+\.rst)"', text)
        assert len(captions) == text.count("report(")
        assert all((ROOT / "workflow" / name).read_text().strip() for name in captions)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_opens_on_a_narrow_screen_with_what_fails_in_red(folder, scheme):
    with chromium() as browser:
        page, requests, complaints = (
            browser.new_page(viewport={"width": 360, "height": 740}, color_scheme=scheme),
            [],
            [],
        )
        page.on("request", lambda request: requests.append(request.url))
        page.on("console", lambda message: complaints.append(message.text))
        page.goto((folder / "index.html").as_uri())
        assert requests == [(folder / "index.html").as_uri()] and complaints == []
        assert page.evaluate("document.documentElement.scrollWidth") <= 360
        row = "document.querySelector('#verdicts tbody tr')"
        assert page.evaluate(f"{row}.dataset.level") == "fail"
        colour = page.evaluate(f"getComputedStyle({row}.querySelector('.reason')).color")
        assert colour == {"light": "rgb(192, 0, 0)", "dark": "rgb(255, 123, 114)"}[scheme]
        background = page.evaluate("getComputedStyle(document.body).backgroundColor")
        lightness = np.mean([int(part) for part in re.findall(r"\d+", background)])
        assert lightness < 50 if scheme == "dark" else lightness > 200
        page.close()
