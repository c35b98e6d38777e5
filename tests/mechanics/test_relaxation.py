"""A force record says what is elastic and what relaxes, and blames time only where elasticity cannot answer."""

import numpy as np
import pytest

from hypernode.mechanics.relaxation import RESOLUTION, fit_relaxation

TIME = np.linspace(0.0, 24.0, 900)
STRETCH = 1.0 + 0.01 * TIME
STEPS = np.array([4.0, 8.0, 12.0])


def neo_hookean(stretch):
    return stretch - stretch**-2


CURVES = {
    "neo-Hookean": neo_hookean(STRETCH),
    "Mooney-Rivlin": neo_hookean(STRETCH) + 1.0 - STRETCH**-3,
    "stiffening": neo_hookean(STRETCH) * (1.0 + 3.0 * (STRETCH**2 + 2.0 / STRETCH - 3.0)),
}


def relaxing(time, elastic, share, tau):
    """Quasi-linear viscoelastic force by trapezoids of the hereditary integral."""
    slope = np.gradient(elastic, time)
    kernel = np.exp(-np.abs(time[:, None] - time[None]) / tau) * (time[:, None] >= time[None])
    return elastic + share * np.trapezoid(kernel * slope[None], time, axis=1)


def factor(time, elastic, share, tau):
    return relaxing(time, elastic, share, tau)[1:] / elastic[1:]


def test_a_relaxing_sheet_is_told_from_its_record():
    elastic = neo_hookean(STRETCH)
    found = fit_relaxation(TIME, STRETCH, 7.0 * relaxing(TIME, elastic, 0.4, 2.0), STEPS)
    late = TIME[1:] > 3.0
    expected = factor(TIME, elastic, 0.4, 2.0)[late]
    np.testing.assert_allclose(np.interp(TIME[1:][late], found.times, found.factor), expected, rtol=0.01)


def test_in_a_hold_the_elastic_force_is_what_remains():
    stretch = 1.0 + 0.02 * np.minimum(TIME, 8.0)
    found = fit_relaxation(TIME, stretch, relaxing(TIME, neo_hookean(stretch), 0.5, 1.5), STEPS)
    assert found.factor[-1] == pytest.approx(1.0, abs=2e-3)
    assert found.factor[len(found.factor) // 3 - 5] > 1.05


@pytest.mark.parametrize("noise", [0.0, 2e-3])
@pytest.mark.parametrize("curve", CURVES)
def test_an_elastic_sheet_does_not_relax_however_its_curve_bends(curve, noise):
    force = 5.0 * CURVES[curve]
    force += noise * force.max() * np.random.default_rng(1).normal(size=force.shape)
    found = fit_relaxation(TIME, STRETCH, force, STEPS)
    np.testing.assert_array_equal(found.factor, 1.0)
    assert found.misfit <= max(RESOLUTION, noise)


def test_the_factor_is_one_on_average_over_the_steps_however_long_the_record():
    """What a test says of stiffness must not depend on how long the machine went on after the last picture."""
    force = relaxing(TIME, neo_hookean(STRETCH), 0.4, 2.0)
    for until in (500, 900):
        found = fit_relaxation(TIME[:until], STRETCH[:until], force[:until], STEPS)
        assert found.at(STEPS).mean() == pytest.approx(1.0)
    assert found.pace > 1.0
