"""How much a stiffness changes gradually: of one material, or of several by a common factor."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from hypernode.identification import budgets, priors
from hypernode.identification.candidate import Candidate
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.trials import Trials


def trend(
    trials: Trials,
    begun: Candidate,
    field: Interfaces,
    factor: Float[np.ndarray, " cell"],
    u: dict[int, np.ndarray],
    steps: list[int],
    finds_window: bool,
    instead: Candidate,
    best: Candidate | None = None,
    bends: Sequence[float] | None = None,
) -> Candidate | None:
    """The likeliest field with a gradual change on top of materials; None without equilibrium.

    A change that bends less is of fewer numbers. It is tried as long as what they cost may decide.

    Args:
        begun: what the move begins from.
        field: its materials and lines.
        factor: where the change begins: the logarithm of a factor in every cell of the grid.
        u: displacement near equilibrium by load step.
        steps: load steps that count.
        finds_window: whether the side of the window is sought.
        instead: the candidate that it competes with.
        best: with larger bends, where these were tried.
        bends: of :class:`~hypernode.identification.gradual.Splines`.
    """
    window, lines = begun.fit.window if finds_window else None, field.count > 1
    for bend in priors.GRADUAL_BENDS if bends is None else bends:
        move, changing = f"a gradual change, bends of {bend:g}", field.changing(factor, bend)
        found = trials.descend(
            move,
            begun,
            begun.problem,
            changing,
            u,
            steps,
            budgets.FAR,
            window,
            finds_window and lines,
            settled=not lines,
        )
        gain = -np.inf if found is None else np.inf if best is None else found.gain_over(best)
        if found is None or gain <= 0.0:
            if found is not None:
                trials.passed_over(found, f"scores {-gain:+.1f} against larger bends")
            break
        if best is not None:
            trials.passed_over(best, f"scores {gain:+.1f} against smaller bends")
        best, field, factor, u = found, found.fit.field, found.fit.field.grid_factor(), found.u
        if best.gain_over(instead) < -best.fit.determined:
            break
    return best
