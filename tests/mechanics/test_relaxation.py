"""A force record says what is elastic and what relaxes, and blames time only where elasticity cannot answer."""

import numpy as np
import pytest

from hypernode.mechanics.record_views import memory
from hypernode.mechanics.relaxation import EVIDENCE, Course, fit_relaxation

END, PACE, FRAMES = 24.0, 0.01, 25
INTERVAL = END / (FRAMES - 1)
#: The recorder begins before the sheet is pulled, and goes on after.
CLOCK = np.linspace(-6.0, END + 6.0, 1201)
STEPS = np.linspace(END / 6.0, END, 6)
#: Largest spread of an elastic record, and deviations within which the truth is.
OPEN, DEVIATIONS = 0.04, 2.0


def first(x):
    return x**2 + 2.0 / x - 3.0


LAWS = {
    "neo-Hookean": lambda x: x - x**-2,
    "Yeoh": lambda x: (x - x**-2) * (1.0 + 0.4 * first(x)),
    "Ogden -4": lambda x: x - x**-5,
    "Ogden -3": lambda x: x**0.5 - x**-4,
    "Gent": lambda x: (x - x**-2) / (1.0 - first(x)),
}
#: (share, relaxation time [s]) of the terms of a Prony series.
SERIES = {
    "one time": [(0.25, 4.0)],
    "a short time": [(0.4, 2.0)],
    "two times": [(0.1, 1.0), (0.2, 5.0)],
    "two decades": [(0.15, 0.8), (0.15, 6.0)],
}


def pulled(time, preload=0.0):
    return (1.0 + preload) * (1.0 + PACE * np.maximum(time, 0.0))


def relaxing(time, elastic, series):
    """Quasi-linear viscoelastic force by trapezoids of the hereditary integral."""
    force, later, apart = elastic.copy(), time[:, None] - time, np.diff(time)
    change = np.gradient(elastic, time) * 0.5 * (np.append(apart, 0.0) + np.append(0.0, apart))
    for share, tau in series:
        kernel = np.exp(-np.abs(later) / tau) * (later >= 0.0)
        force += share * kernel @ change
    return force


def alone(time, stretch, force, steps, **further):
    """What one record says."""
    return fit_relaxation([Course(time=time, stretch=stretch, force=force, steps=steps, **further)])[0]


def recorded(force, noise=0.0, lag=0.0, seed=0):
    """What a record with noise that is late by some frames says between rest and the end of the pull."""
    force = force + noise * force.max() * np.random.default_rng(seed).normal(size=force.shape)
    time = CLOCK[(CLOCK >= 0.0) & (CLOCK <= END)]
    return alone(time, pulled(time), np.interp(time - lag * INTERVAL, CLOCK, force), STEPS, interval=INTERVAL)


@pytest.mark.parametrize(
    ("preload", "lag"), [(0.0, 0), (0.01, 0), (0.02, 0), (0.0, 1), (0.0, 3), (0.0, -3)], ids=lambda value: f"{value:g}"
)
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("noise", [1e-3, 3e-3])
def test_an_elastic_record_is_not_called_relaxing_whatever_its_curve_preload_and_clock(law, preload, lag, noise):
    found = recorded(LAWS[law](pulled(CLOCK, preload)), noise, lag)
    np.testing.assert_array_equal(found.at(STEPS), 1.0)
    assert found.odds < EVIDENCE and found.spread <= OPEN


@pytest.mark.parametrize("series", SERIES)
@pytest.mark.parametrize("law", ["neo-Hookean", "Yeoh", "Ogden -4"])
@pytest.mark.parametrize("noise", [1e-3, 3e-3])
def test_what_is_elastic_of_a_relaxing_record_is_within_two_spreads(law, series, noise):
    elastic = LAWS[law](pulled(CLOCK))
    force = relaxing(CLOCK, elastic, SERIES[series])
    found = recorded(force, noise)
    factor = np.interp(STEPS, CLOCK, force) / np.interp(STEPS, CLOCK, elastic)
    error = found.at(STEPS) / (factor / factor.mean()) - 1.0
    assert np.sqrt(np.mean(error**2)) <= DEVIATIONS * found.spread


def two_paces(law, series, *, slower=10.0, preload=0.0, lags=(0, 0), gains=(0.0, 0.0), noise=1e-3):
    """(courses, recorded over elastic force at their steps) of a test and of one that is so many times slower."""
    courses, true = [], []
    for k, (end, lag, gain) in enumerate(zip((END, slower * END), lags, gains, strict=True)):
        clock = CLOCK * end / END
        elastic = LAWS[law](pulled(CLOCK, preload))
        force = relaxing(clock, elastic, series)
        said = (1.0 + gain) * force + noise * force.max() * np.random.default_rng(k).normal(size=force.shape)
        time, steps = clock[(CLOCK >= 0.0) & (CLOCK <= END)], STEPS * end / END
        interval = INTERVAL * end / END
        late = np.interp(time - lag * interval, clock, said)
        stretch = pulled(time * END / end)
        courses.append(Course(time=time, stretch=stretch, force=late, steps=steps, interval=interval, gain=0.01))
        true.append(np.interp(steps, clock, force) / np.interp(steps, clock, elastic))
    return courses, np.concatenate(true)


@pytest.mark.parametrize(
    ("law", "slower", "preload", "lags"),
    [("neo-Hookean", 10.0, 0.0, (0, 0)), ("Yeoh", 10.0, 0.01, (1, -1)), ("Ogden -4", 3.0, 0.02, (0, 3))],
    ids=lambda value: str(value),
)
def test_two_paces_of_an_elastic_sheet_find_no_relaxation_whatever_its_curve_preload_clocks_and_gains(
    law, slower, preload, lags
):
    courses, _ = two_paces(law, [], slower=slower, preload=preload, lags=lags, gains=(0.01, -0.01))
    for found in fit_relaxation(courses):
        assert not found.found and found.spread <= OPEN


@pytest.mark.parametrize(
    "law", ["Yeoh", *(pytest.param(law, marks=pytest.mark.slow) for law in ("neo-Hookean", "Ogden -4"))]
)
def test_two_paces_tell_the_level_of_a_sheet_that_relaxes_better_than_one(law):
    """By 20 per cent of its relaxed stiffness: both tests are of one material, and each alone is of its own."""
    courses, true = two_paces(law, [(0.2, 4.0)], gains=(0.005, -0.005))
    both, apart = fit_relaxation(courses), [fit_relaxation([course])[0] for course in courses]
    true /= true.mean()

    def error_of(found):
        at = np.concatenate([each.at(course.steps) for each, course in zip(found, courses, strict=True)])
        return np.sqrt(np.mean((at / true - 1.0) ** 2))

    spread = np.sqrt(np.mean([each.spread**2 for each in both]))
    assert all(each.found and each.pace == both[0].pace for each in both)
    assert error_of(both) <= DEVIATIONS * spread
    assert max(spread, 2.0 * error_of(both)) < error_of(apart)


def test_a_relaxing_sheet_is_told_from_its_record():
    """Concave from the first moment on, as no elastic curve is."""
    elastic = LAWS["neo-Hookean"](pulled(CLOCK))
    force = relaxing(CLOCK, elastic, [(0.4, 2.0)])
    found = recorded(7.0 * force, 1e-3)
    factor = np.interp(STEPS, CLOCK, force) / np.interp(STEPS, CLOCK, elastic)
    assert found.odds > EVIDENCE
    np.testing.assert_allclose(found.at(STEPS), factor / factor.mean(), rtol=0.03)


def test_in_a_hold_the_elastic_force_is_what_remains():
    time = np.linspace(0.0, END, 900)
    stretch = 1.0 + 0.02 * np.minimum(time, 8.0)
    found = alone(time, stretch, relaxing(time, LAWS["neo-Hookean"](stretch), [(0.5, 1.5)]), STEPS)
    assert found.odds > EVIDENCE
    assert found.factor[-1] == pytest.approx(1.0, abs=0.01)
    assert np.interp(7.8, found.times, found.factor) > 1.05


def test_forces_that_are_held_out_change_nothing():
    elastic = LAWS["neo-Hookean"](pulled(CLOCK))
    force, seen = relaxing(CLOCK, elastic, [(0.4, 2.0)]), CLOCK < 12.0
    found = [
        alone(CLOCK, pulled(CLOCK), np.where(seen, force, other), STEPS, interval=INTERVAL, seen=seen)
        for other in (force, 0.0, 5.0 * force)
    ]
    assert found[0].odds > EVIDENCE
    for each in found[1:]:
        np.testing.assert_array_equal(each.factor, found[0].factor)


def test_the_factor_is_one_on_average_over_the_steps_however_long_the_record():
    """What a test says of stiffness must not depend on how long the machine went on after the last picture."""
    force = relaxing(CLOCK, LAWS["neo-Hookean"](pulled(CLOCK)), [(0.4, 2.0)])
    for until in (700, 1100):
        during = slice(240, until)
        found = alone(CLOCK[during], pulled(CLOCK[during]), force[during], STEPS[:2])
        assert found.at(STEPS[:2]).mean() == pytest.approx(1.0)
    assert found.pace > 1.0


def test_a_record_without_force_tells_nothing():
    found = alone(CLOCK, pulled(CLOCK), np.zeros(len(CLOCK)), STEPS)
    np.testing.assert_array_equal(found.at(STEPS), 1.0)


@pytest.mark.parametrize("count", [1, 2, 3, 64, 65])
def test_the_memory_of_a_course_is_the_sum_over_its_samples(count):
    elastic, step, tau = np.random.default_rng(1).random((2, count)).cumsum(axis=1), 0.1, 0.7
    rates = np.diff(elastic, prepend=elastic[:, :1]) / step
    expected, total = np.zeros_like(elastic), np.zeros(2)
    for k in range(count):
        # Over one step the rate is constant, and what was there before fades.
        total = np.exp(-step / tau) * total + tau * (1.0 - np.exp(-step / tau)) * rates[:, k]
        expected[:, k] = total
    np.testing.assert_allclose(memory(elastic, step, tau), expected, rtol=1e-12, atol=1e-15)
