"""The score of a candidate: the negative logarithm of its posterior probability."""

import numpy as np

from hypernode.identification.problem import FieldProblem
from hypernode.trace import Score


def score_of(
    problem: FieldProblem, *, white, cost: float, shared: float, terms: int, determined: float, places: float
) -> Score:
    """The cost plus all parts that differ between candidates.

    The covariance of the residuals joins, by their uncertainty and by the errors that they share, so that the score
    does not depend on the scale of residuals. A parameter of the terms, of which the sheet has one, costs half the
    logarithm of the number of data (Schwarz, Estimating the dimension of a model, 1978). Every number that the data
    determine costs one (Akaike 1974; Spiegelhalter et al., Bayesian measures of model complexity and fit, 2002). Half
    of that is noise that the field fits. The other half is what the field misses other data by for that reason.

    Args:
        problem: the test.
        white: misfits of displacements and of forces over their uncertainty, free of shared errors.
        cost: the objective, with what the field costs without data.
        shared: logarithm of the determinant of what residuals share.
        terms: number of parameters of the law.
        determined: number of parameters of the field that the data determine.
        places: logarithm of the number of places where an interface might be.
    """
    data = max(problem.observed, 1)
    of_u, of_f = (0.5 * float(r @ r) for r in white)
    relative = sum(float(np.log(boundary.relative).sum()) for boundary in problem.observations.boundaries)
    relative += sum(float(np.log(force.sigma)) for force in problem.forces)
    return Score(
        displacements=of_u,
        forces=of_f,
        prior=cost - of_u - of_f,
        noise=data * float(np.log(problem.sigma)) + relative + 0.5 * shared,
        terms=0.5 * terms * float(np.log(data)),
        determined=determined,
        places=places,
    )
