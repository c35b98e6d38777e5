"""A figure of a run that does not pass says so before anything else, in every layout and format."""

import io
import json
import re
import zlib
from functools import cache

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.text import Text

from hypernode.figures.render import LAYOUTS, MEASURED, SEVERAL, compose
from hypernode.figures.style import RC
from hypernode.figures.trust import COLOURS, LINES, run_verdict, write_verdict
from hypernode.tables.verdicts import VerdictError
from tests.figures.data import SENTENCES, evaluation, figure_input, verdict


@pytest.fixture(autouse=True, scope="module")
def _closed():
    yield
    drawn.cache_clear()
    plt.close("all")


@cache
def drawn(kind, level):
    return compose(*figure_input(kind, level))


def rendered(figure, **options) -> bytes:
    buffer = io.BytesIO()
    with plt.rc_context(RC):
        figure.savefig(buffer, **options)
    return buffer.getvalue()


def pixels(figure, colour) -> np.ndarray:
    """(row, column) of pixels in a colour, as shares of the picture."""
    picture = plt.imread(io.BytesIO(rendered(figure, format="png", dpi=60)))[..., :3]
    found = np.argwhere(np.abs(picture - to_rgb(colour)).max(axis=-1) < 0.02)
    return found / picture.shape[:2]


@pytest.mark.slow
@pytest.mark.parametrize("level", COLOURS)
@pytest.mark.parametrize("kind", [kind for kind in LAYOUTS if kind not in MEASURED])
def test_a_run_that_does_not_pass_has_a_line_in_the_colour_of_its_level_across_the_top(kind, level):
    found = pixels(drawn(kind, level), COLOURS[level])
    top = found[found[:, 0] < 0.25]
    assert len(top) > 20 and np.ptp(top[:, 1]) > 0.3
    assert not len(pixels(drawn(kind, "pass"), COLOURS[level])), "the colour is kept for verdicts"


def luminance(colour) -> float:
    """Relative luminance after WCAG 2."""
    channels = np.array(to_rgb(colour))
    linear = np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    return float(linear @ (0.2126, 0.7152, 0.0722))


def test_red_and_amber_are_read_on_white_and_told_apart_without_hue():
    red, amber = (luminance(COLOURS[level]) for level in ("fail", "warn"))
    assert all(1.05 / (each + 0.05) > 3.0 for each in (red, amber)), "contrast that WCAG asks of large letters"
    assert amber > 1.8 * red


@pytest.mark.parametrize("kind", [kind for kind in LAYOUTS if kind not in MEASURED])
def test_the_line_is_the_largest_text_and_stands_above_all_others(kind):
    figure = drawn(kind, "fail")
    figure.draw_without_rendering()
    others = [text for text in figure.findobj(Text) if text.get_text() and text is not figure._suptitle]
    assert figure._suptitle.get_fontsize() > 1.15 * max(text.get_fontsize() for text in others)
    line = figure._suptitle.get_window_extent()
    assert all(part.get_tightbbox().y1 <= line.y0 for part in [*figure.axes, *figure.legends])
    assert line.width <= figure.bbox.width


@pytest.mark.parametrize("level", COLOURS)
@pytest.mark.parametrize("kind", [kind for kind in LAYOUTS if kind not in (*SEVERAL, *MEASURED)])
def test_the_line_begins_with_the_level_and_gives_the_reason(kind, level):
    text = drawn(kind, level)._suptitle.get_text().replace("\n", " ")
    assert text.startswith(f"{level}: {SENTENCES[level]}")


def test_what_passes_has_no_line():
    assert drawn("identification", "pass")._suptitle is None


def test_more_sentences_than_there_is_room_for_end_in_dots():
    judged = verdict("fail")
    file = evaluation("fail", verdict=json.dumps(judged | {"criteria": 3 * judged["criteria"]}))
    figure = plt.figure(figsize=(7.2, 4.0))
    write_verdict(figure, *run_verdict(file))
    text = figure.get_suptitle()
    assert text.count("\n") == LINES - 1 and text.endswith(" ...")


def test_an_evaluation_without_a_verdict_is_answered_with_the_way_out():
    file = evaluation()
    del file.attrs["verdict"]
    with pytest.raises(VerdictError, match="delete it and run again"):
        run_verdict(file)


def test_the_line_is_text_in_the_pdf():
    def text(level):
        pdf = rendered(drawn("identification", level), format="pdf")
        streams = re.findall(rb"stream\r?\n(.*?)\r?\nendstream", pdf, re.S)
        pages = b"".join(zlib.decompress(s) for s in streams if s[:1] == b"\x78")
        # Letters stand in brackets, two bytes each, with their kerning between them.
        letters = b"".join(re.findall(rb"\((.*?)(?<!\\)\)", pages, re.S))
        return letters.replace(b"\0", b"").decode("latin-1")

    assert "displacements over their noise is 3.21" in text("fail")
    assert "displacements over their noise" not in text("pass")


def test_a_comparison_marks_the_rows_that_do_not_pass():
    figure = drawn("comparison", "warn")
    labels = {axes.get_ylabel(): axes.yaxis.label.get_color() for axes in figure.axes if axes.get_ylabel()}
    assert labels == {"truth": "black", "first": "black", "second\n(warn)": COLOURS["warn"]}
    assert figure._suptitle.get_text() == "warn: 1 pass, 1 warn, of 2 rows."
