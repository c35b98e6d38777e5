"""What a figure says first where its numbers are not to be relied on."""

import textwrap

from hypernode.tables.verdicts import LEVELS, RunVerdict, count

#: Colours of the levels that are written, used for nothing else. Amber is twice as light as red, so that they differ
#: without colours too; the text begins with the level in any case.
COLOURS = {"fail": "#C00000", "warn": "#B86E00"}
#: Sentences of a verdict that are written; the command ``hypernode verdict`` prints the others.
SENTENCES = 2
#: Size of the letters in points, and the least that a narrow figure makes of it.
LARGE, SMALL = 12.0, 10.0
#: Characters of a line below which its letters become smaller.
LINE = 60
#: Mean width of a bold letter over its size.
LETTER = 0.6


def overall(evaluation) -> str:
    """The overall level of an opened evaluation."""
    return RunVerdict.of(evaluation).overall


def run_verdict(evaluation) -> tuple[str, list[str]]:
    """(level, its first sentences) of one run; no sentences where it passes."""
    verdict = RunVerdict.of(evaluation)
    sentences = verdict.sentences[:SENTENCES]
    left = len(verdict.sentences) - len(sentences)
    return verdict.overall, [*sentences, *([f"And {left} more."] if left else [])]


def rows_verdict(evaluations) -> tuple[str, list[str]]:
    """(worst level, how many rows have which) of several runs; nothing to say where all pass."""
    levels = [overall(evaluation) for evaluation in evaluations]
    worst = min(levels, key=LEVELS.index)
    return worst, [f"{count(levels)}, of {len(levels)} rows."] if worst in COLOURS else []


def write_verdict(figure, level: str, sentences: list[str]) -> None:
    """Write a verdict across the top of a figure; nothing is changed where it says nothing.

    Args:
        figure: a matplotlib figure whose layout leaves room for a title.
        level: one of :data:`COLOURS`, where there are sentences.
        sentences: what to write after the level.
    """
    if not sentences:
        return
    room = 72.0 * figure.get_figwidth() / LETTER
    size = min(LARGE, max(SMALL, room / LINE))
    text = textwrap.fill(f"{level}: {' '.join(sentences)}", int(room / size))
    figure.suptitle(text, color=COLOURS[level], fontweight="bold", fontsize=size)
