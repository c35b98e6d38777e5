"""The problem whose answer an equilibrium field is, from its file and its measurement."""

import numpy as np

from hypernode.config.methods import Constrained
from hypernode.data.believed_noise import BelievedNoise
from hypernode.data.believed_window import BelievedWindow
from hypernode.data.measurement import displacement_noise
from hypernode.errors import ExpectedError
from hypernode.identification.problem import FieldProblem, problem_of_basis
from hypernode.mechanics.point_law import PointLaw

#: Relative difference of two uncertainties of displacements that are the same: rounding of a file.
ROUNDING = 1e-6


class OtherUncertainty(ExpectedError, ValueError):
    """The displacements are not as uncertain as when the field was identified; the message says by how much."""


def problem_as_identified(
    measurement, field, settings: Constrained, law: PointLaw, subcells: int
) -> tuple[FieldProblem, object]:
    """(the problem with the noise and the window that a field was identified with, the measurement as it was taken).

    Args:
        measurement, field: opened files, the field that of the measurement.
        settings: configuration of the stage that identified it.
        law: the law of the problem.
        subcells: rows and columns into which every measured cell is divided, as in the field.

    Raises:
        OtherUncertainty: no noise model of the measurement is that of the field.
    """
    sigma = float(field.attrs["displacement_sigma"])
    window = BelievedWindow.read(field.attrs)
    taken = BelievedNoise.read(field.attrs).of(measurement if window is None else window.of(measurement))
    # What is not noise is what finite elements were taken to miss.
    floor = float(np.sqrt(max(sigma**2 - displacement_noise(taken) ** 2, 0.0)))
    problem = problem_of_basis(taken, settings, law, subcells, floor=floor, at_lines=field.attrs["layered"] == "true")
    if abs(problem.sigma - sigma) <= ROUNDING * sigma:
        return problem, taken
    raise OtherUncertainty(
        f"the uncertainty of the displacements is another one than when the field was identified, {problem.sigma:.4g} "
        f"and {sigma:.4g}: run it again"
    )
