"""The laws of the phases of a sheet whose shape is known, and where the shape lies; of one phase its law alone.

Lines keep their shape and move as a whole, since a picture of what was made is registered to a test within some points
only. All phases begin as the homogeneous sheet.
"""

import dataclasses

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.config.methods import Constrained
from hypernode.data.measurement import window_sought
from hypernode.identification import budgets
from hypernode.identification.gauss_newton import IdentificationError
from hypernode.identification.interface_answer import answer
from hypernode.identification.interface_estimate import InterfaceEstimate
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.law_search import LawSearch
from hypernode.identification.lines import Lines
from hypernode.identification.trials import Trials, homogeneous_displacement, largest_and_half


def of_shape(
    measurement: xr.Dataset,
    distances: Float[np.ndarray, "line node"],
    settings: Constrained,
    name: str,
) -> InterfaceEstimate:
    """The laws of phases whose lines are known but for a shift.

    Args:
        measurement: an opened measurement.
        distances: of every node of the measured grid from the line of each phase but the first, positive within, in
            sides of cells.
        settings: configuration of the stage.
        name: case, for progress and messages.

    Raises:
        IdentificationError: the sheet finds no equilibrium.
    """
    trials = Trials(measurement, settings, name)
    problem = trials.plainest()
    steps, u = largest_and_half(problem), homogeneous_displacement(problem)
    finds = len(distances) > 0 and window_sought(measurement)
    lines = dataclasses.replace(Lines.of(problem.observations.grid, problem.refinement), as_one=True)
    field = Interfaces(lines, np.tile(problem.homogeneous.params, (len(distances) + 1, 1)), distances)
    found = trials.descend("phases of the known shape", None, problem, field, u, steps, budgets.FAR, None, finds)
    if found is None:
        raise _no_equilibrium(name)
    found = LawSearch(trials, steps, finds).end(found)
    window = found.fit.window if finds else None
    found = trials.descend(
        "finer elements", found, *trials.on_finer_elements(found), steps, budgets.NEAR, window, finds
    )
    estimate = None if found is None else answer(trials, found, finds)
    if estimate is None:
        raise _no_equilibrium(name)
    return estimate


def _no_equilibrium(name: str) -> IdentificationError:
    return IdentificationError(
        f"{name}: the sheet finds no equilibrium with phases where the picture has them: see that the picture is of "
        "this sheet and lies as it does (--flipped), or leave out the largest load steps"
    )
