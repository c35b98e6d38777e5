"""A figure of a run that did not converge says so before anything else, in every layout and format."""

import io
import re
import zlib
from functools import cache

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.text import Text

from hypernode.figures.render import LAYOUTS, compose
from hypernode.figures.style import RC
from hypernode.figures.trust import WARNING
from tests.figures.data import figure_input


@pytest.fixture(autouse=True, scope="module")
def _closed():
    yield
    drawn.cache_clear()
    plt.close("all")


@cache
def drawn(kind, ending):
    return compose(*figure_input(kind, ending))


def rendered(figure, **options) -> bytes:
    buffer = io.BytesIO()
    with plt.rc_context(RC):
        figure.savefig(buffer, **options)
    return buffer.getvalue()


def warning_pixels(figure) -> np.ndarray:
    """(row, column) of pixels in the colour of a warning, as shares of the picture."""
    picture = plt.imread(io.BytesIO(rendered(figure, format="png", dpi=60)))[..., :3]
    found = np.argwhere(np.abs(picture - to_rgb(WARNING)).max(axis=-1) < 0.02)
    return found / picture.shape[:2]


@pytest.mark.parametrize("kind", LAYOUTS)
def test_a_run_that_did_not_converge_has_a_red_line_across_the_top(kind):
    pixels = warning_pixels(drawn(kind, "out of iterations"))
    top = pixels[pixels[:, 0] < 0.15]
    assert len(top) > 50 and np.ptp(top[:, 1]) > 0.4
    assert not len(warning_pixels(drawn(kind, "converged"))), "red is kept for warnings"


@pytest.mark.parametrize("kind", LAYOUTS)
def test_the_line_is_the_largest_text_and_stands_above_all_others(kind):
    figure = drawn(kind, "out of iterations")
    figure.draw_without_rendering()
    others = [text for text in figure.findobj(Text) if text.get_text() and text is not figure._suptitle]
    assert figure._suptitle.get_fontsize() > 1.2 * max(text.get_fontsize() for text in others)
    line = figure._suptitle.get_window_extent()
    assert all(part.get_tightbbox().y1 <= line.y0 for part in [*figure.axes, *figure.legends])
    assert line.width <= figure.bbox.width


@pytest.mark.parametrize("kind", [kind for kind in LAYOUTS if kind != "comparison"])
def test_the_line_names_the_ending_and_the_misfit(kind):
    for ending in ("out of iterations", "stagnated"):
        text = drawn(kind, ending)._suptitle.get_text()
        assert f"not converged: {ending}" in text and "misfit of u 3.21 × noise" in text


def test_a_method_that_searches_for_no_field_has_no_line():
    assert drawn("identification", None)._suptitle is None


def test_the_line_is_text_in_the_pdf():
    def text(ending):
        pdf = rendered(drawn("identification", ending), format="pdf")
        streams = re.findall(rb"stream\r?\n(.*?)\r?\nendstream", pdf, re.S)
        pages = b"".join(zlib.decompress(s) for s in streams if s[:1] == b"\x78")
        # Letters stand in brackets, two bytes each, with their kerning between them.
        letters = b"".join(re.findall(rb"\((.*?)(?<!\\)\)", pages, re.S))
        return letters.replace(b"\0", b"").decode("latin-1")

    assert "not converged: out of iterations" in text("out of iterations")
    assert "not converged" not in text("converged")


def test_a_comparison_marks_the_rows_that_did_not_converge():
    figure = drawn("comparison", "stagnated")
    labels = {axes.get_ylabel(): axes.yaxis.label.get_color() for axes in figure.axes if axes.get_ylabel()}
    assert labels == {"truth": "black", "first": "black", "second\n(not converged)": WARNING}
    assert figure._suptitle.get_text() == "not converged: 1 of 2 rows"
