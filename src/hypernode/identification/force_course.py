"""Check of the forces against hyperelastic materials at the mean deformation of the sheet."""

from collections.abc import Callable

import numpy as np

from hypernode.config.methods import Constrained
from hypernode.errors import ExpectedError
from hypernode.identification import thresholds
from hypernode.identification.problem import FieldProblem


class ImpossibleForcesError(ExpectedError, RuntimeError):
    """No material explains the forces of a load case; the message names the load case and the misfit."""


def check_forces(problem_of: Callable[..., FieldProblem], settings: Constrained, name: str) -> None:
    """Refuse forces that no homogeneous material follows over the load steps.
    Richer materials are tried until one follows: neo-Hookean, then all terms, then further ones.

    Args:
        problem_of: problem with some terms of the basis.
        settings: of the stage.
        name: case, for the message.

    Raises:
        ImpossibleForcesError: no material follows them.
    """
    first = [term for term in settings.terms if term == "J"]
    richer = (first, settings.terms, [*settings.terms, *settings.further_terms])
    for terms in richer:
        problem = problem_of(*terms)
        misfit = problem.homogeneous.force_misfit
        if misfit.max() <= thresholds.IMPOSSIBLE_FORCES:
            return
    case = int(np.argmax(misfit))
    loading, F = problem.observations.loading, problem.observations.mean_F
    steps = np.flatnonzero(loading.load_case == case)
    normal = np.eye(2, dtype=bool)
    seen = "; ".join(
        f"{_shown(loading.P_average[step], loading.measured[step] & normal)} at F = {_shown(F[:, :, step], normal)}"
        for step in steps
    )
    raise ImpossibleForcesError(
        f"{name}: the forces of load case {case} are missed by {misfit[case]:.0%} by every homogeneous sheet "
        f"({', '.join(richer[-1]) or 'neo-Hookean'}), more than {thresholds.IMPOSSIBLE_FORCES:.0%}: no sheet "
        f"gives a mean stress of {seen} (normal components, force over section). Check sign, channel, unit "
        "and clock of the record, and that it is of this test"
    )


def unless_impossible(search: Callable):
    """What a search finds; None where no sheet of its laws gives the forces, as sheets of other laws may."""
    try:
        return search()
    except ImpossibleForcesError:
        return None


def _shown(tensor, known) -> str:
    return "(" + ", ".join(f"{tensor[i, J]:.3g}" for i, J in zip(*np.nonzero(known), strict=True)) + ")"
