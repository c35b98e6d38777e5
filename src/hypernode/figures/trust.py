"""What a figure says first where its numbers are not to be relied on."""

import textwrap

from hypernode.tables.verdicts import RunVerdict, count
from hypernode.verdict import Level

#: Colours of the levels that are written, used for nothing else. Amber is twice as light as red, so that they differ
#: without colours too; the text begins with the level in any case.
COLOURS = {Level.FAILED: "#C00000", Level.WARNED: "#B86E00"}
#: Lines that there is room for above a figure; the command ``hypernode verdict`` prints what they leave out.
LINES = 2
#: Size of the letters in points.
SIZE = 10.0
#: Mean width of a bold letter over its size.
LETTER = 0.6


def overall(evaluation) -> Level:
    """The overall level of an opened evaluation."""
    return RunVerdict.of(evaluation).verdict.overall


def run_verdict(evaluation) -> tuple[Level, list[str]]:
    """(level, sentences on what is not met) of one run; no sentences where it passes."""
    verdict = RunVerdict.of(evaluation).verdict
    return verdict.overall, verdict.sentences


def runs_verdict(evaluations, shown: str) -> tuple[Level, list[str]]:
    """(worst level, how many have which) of several runs; nothing to say where all pass.

    Args:
        evaluations: opened, of all runs.
        shown: what a figure shows of each: ``rows``.
    """
    levels = [overall(evaluation) for evaluation in evaluations]
    worst = max(levels, key=lambda level: level.rank)
    return worst, [f"{count(levels)}, of {len(levels)} {shown}."] if worst in COLOURS else []


def name_row(axes, title: str, level: Level) -> None:
    """Name a row of panels at its first one; a run that does not pass says so in the colour of its level."""
    colour = COLOURS.get(level)
    axes.set_ylabel(f"{title}\n({level})" if colour else title, color=colour or "black")


def write_verdict(figure, level: Level, sentences: list[str]) -> None:
    """Write a verdict across the top of a figure; nothing is changed where it says nothing.

    Args:
        figure: a matplotlib figure whose layout leaves room for a title.
        level: one of :data:`COLOURS`, where there are sentences.
        sentences: what to write after the level.
    """
    if not sentences:
        return
    letters = int(72.0 * figure.get_figwidth() / (LETTER * SIZE))
    text = textwrap.fill(f"{level}: {' '.join(sentences)}", letters, max_lines=LINES, placeholder=" ...")
    # A layout engine finds the place; without one, the line goes to where a figure leaves room for it.
    place = {} if figure.get_layout_engine() else {"y": 0.99}
    figure.suptitle(text, color=COLOURS[level], fontweight="bold", fontsize=SIZE, **place)
