"""The caption of a figure says what each of its panels is."""

import re
from pathlib import Path

import jinja2
import matplotlib.pyplot as plt
import pytest

from hypernode.config.loading import load_config
from hypernode.figures.render import LAYOUTS, compose
from tests.figures.data import figure_input

ROOT = Path(__file__).resolve().parents[2]
TEMPLATE = jinja2.Template((ROOT / "workflow/report/figure.rst").read_text(), undefined=jinja2.StrictUndefined)


def _settings():
    """Kind -> settings of one figure of it, as a configuration has them."""
    files = ("config.yaml", "pictures.yaml")
    figures = [figure for file in files for figure in load_config(ROOT / "config" / file).figures.values()]
    known = {figure.kind: figure.model_dump(mode="json") for figure in figures}
    return known | {"detection": {"kind": "detection", "runs": ["*"]}}


SETTINGS = _settings()


@pytest.mark.parametrize("kind", LAYOUTS)
def test_a_caption_names_the_run_and_every_lettered_panel(kind):
    settings = SETTINGS[kind]
    text = TEMPLATE.render(snakemake={"params": {"settings": settings}})
    figure = compose(*figure_input(kind, "pass"))
    drawn = {match[1] for axes in figure.axes if (match := re.match(r"\((\w)\)", axes.get_title(loc="left")))}
    plt.close("all")
    named = set(re.findall(r"\((\w)\)", text)) | {
        letter for pair in re.findall(r"\((\w), (\w)\)", text) for letter in pair
    }
    assert drawn <= named
    shown = [settings] if "case" in settings else settings["runs"]
    assert all(run["case"] in text for run in shown if isinstance(run, dict))
