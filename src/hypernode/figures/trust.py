"""What a figure says first where its numbers are not to be relied on."""

import json

from hypernode.tables.columns import significant
from hypernode.tables.runs import CONVERGED

#: Colour of a warning, used for nothing else.
WARNING = "#C00000"
#: Size of a warning's letters in points, unless the figure is too narrow for it.
LARGE = 12.0
#: Mean width of a bold letter over its size.
LETTER = 0.6


def unfinished(evaluation) -> str:
    """How a run ended that did not converge, empty for all others.

    Methods that search for no equilibrium field do not say how they ended, and nothing is said of them.
    """
    ending = json.loads(evaluation.attrs["summary"]).get("ending", CONVERGED)
    return "" if ending == CONVERGED else ending


def run_warning(evaluation) -> list[str]:
    """Lines that say that a run did not converge, and its misfit; none where it did."""
    ending = unfinished(evaluation)
    if not ending:
        return []
    misfit = json.loads(evaluation.attrs["summary"]).get("displacement_misfit")
    return [f"not converged: {ending}", *([] if misfit is None else [f"misfit of u {significant(misfit)} × noise"])]


def rows_warning(evaluations) -> list[str]:
    """The line above several runs of which some did not converge; none where all did."""
    stopped = sum(bool(unfinished(evaluation)) for evaluation in evaluations)
    return [f"not converged: {stopped} of {len(evaluations)} rows"] if stopped else []


def warn(figure, lines: list[str]) -> None:
    """Write a warning across the top of a figure, in one line where there is room.

    Args:
        figure: a matplotlib figure whose layout leaves room for a title.
        lines: what to write; nothing is changed where it is empty.
    """
    if not lines:
        return
    room = 72.0 * figure.get_figwidth() / LETTER
    text = "; ".join(lines)
    if len(text) * LARGE > room:
        text = "\n".join(lines)
    longest = max(map(len, text.splitlines()))
    figure.suptitle(text, color=WARNING, fontweight="bold", fontsize=min(LARGE, room / longest))
