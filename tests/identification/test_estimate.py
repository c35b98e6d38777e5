"""How sure an estimate is: by what the test tells, and by less where it does not follow the test."""

import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.identification.gauss_newton import descend
from hypernode.identification.problem import field_problem
from hypernode.mechanics.loads import make_load
from tests.sheets import sheet, square


@pytest.mark.parametrize(("terms", "own"), [pytest.param((), False, marks=pytest.mark.slow), (("I1_squared",), True)])
def test_samples_scatter_by_as_much_more_as_forces_are_missed_by_more_than_chance(terms, own):
    values = {"log1p_I1_squared": 1.5}
    load = make_load("equibiaxial", [1.1, 1.2, 1.3])
    data, _, _ = sheet(5, square, load, noise=7e-4, terms=("I1_squared",), values=values.items())
    settings = Constrained(terms=list(terms), force_noise=0.005, iterations=15)
    found = descend(field_problem(data, settings), settings, "square", None, settings.tolerance)
    factor = 1.0 if own else found.misfits["force"]
    assert (found.misfits["force"] < 1.5) == own
    as_told = found.objective.posterior_samples(found.linear, found.params, 2, 1, found.step.deflation)
    samples = np.moveaxis(found.samples(2, 1)[:, :, 0], 0, -1)
    np.testing.assert_allclose(samples - found.params, factor * (as_told - found.params), atol=1e-12)
