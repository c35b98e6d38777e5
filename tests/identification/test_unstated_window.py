"""The window of an engine that nobody stated is told by the interface of a sheet of two materials."""

import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.data.believed_window import BelievedWindow
from hypernode.data.measurement import correlation_window, window_uncertainty
from hypernode.identification.gauss_newton import descend
from hypernode.identification.problem import field_problem
from hypernode.identification.strategy import identify
from hypernode.identification.unstated_window import unstated_window
from hypernode.mechanics.loads import make_load
from tests.sheets import believed, observed_coarsely

NOISE, CELLS, WINDOW = 3e-4, 12, 2.5 / 12.0
SETTINGS = Constrained(terms=[], layers=True)


def disc(X):
    return (np.linalg.norm(X - [0.48, 0.53], axis=1) < 0.27).astype(float)


def seen_through(window, uncertainty=0.25, inclusion=disc):
    """(noisy measurement of a sheet, computed on twice as many cells, that states no window; its field of mixtures)."""
    data, _ = observed_coarsely(CELLS, inclusion, make_load("equibiaxial", [1.05, 1.1, 1.15]), window)
    noise = np.random.default_rng(3).normal(0.0, NOISE, data["u_measured"].shape)
    data = believed(data.assign(u_measured=data["u_measured"] + noise), NOISE)
    data = data.assign_attrs(mesh="finer", correlation_window=0.0, window_uncertainty=uncertainty)
    problem = field_problem(data, SETTINGS)
    return data, descend(problem, SETTINGS, "sheet", None, (), SETTINGS.tolerance)


@pytest.fixture(scope="module")
def through_a_window():
    return seen_through(WINDOW)


def test_two_materials_tell_the_window_and_how_well_it_is_known(through_a_window):
    data, free = through_a_window
    window = unstated_window(free, data, SETTINGS, "sheet")
    # Interpolants between points smooth as well, as a window of two squared steps; those of the finer mesh did before.
    side = np.sqrt(WINDOW**2 - 2.0 * (CELLS**-2.0 - (2.0 * CELLS) ** -2.0))
    assert abs(window.side - side) < 2.0 * window.error
    assert 0.0 < window.error < 0.1 * WINDOW


def test_points_that_are_exact_and_a_window_that_is_stated_are_believed(through_a_window):
    data, free = through_a_window
    assert unstated_window(free, data.assign_attrs(window_uncertainty=0.0), SETTINGS, "sheet") is None
    assert unstated_window(free, data, Constrained(terms=[]), "sheet") is None
    stated = field_problem(data.assign_attrs(correlation_window=WINDOW), SETTINGS)
    known = descend(stated, SETTINGS, "sheet", None, (), SETTINGS.tolerance)
    assert unstated_window(known, data, SETTINGS, "sheet") is None


@pytest.mark.slow
def test_a_field_is_identified_through_the_window_that_it_tells(through_a_window):
    data, _ = through_a_window
    found = identify(data, SETTINGS, "sheet")
    blind = identify(data.assign_attrs(window_uncertainty=0.0), SETTINGS, "sheet")
    assert found.layered and found.problem.observations.believed_window is not None

    def error(each):
        stiff, soft = np.exp(each.by_parts[0]).mean(axis=0).max(), np.exp(each.by_parts[0]).mean(axis=0).min()
        return abs(stiff / soft / 2.0 - 1.0)

    assert error(found) < 0.03 and error(found) < 0.5 * error(blind)


@pytest.mark.slow
def test_of_points_without_a_window_and_of_one_material_none_is_found():
    for data, free in (seen_through(0.0), seen_through(WINDOW, inclusion=lambda X: np.zeros(len(X)))):
        assert unstated_window(free, data, SETTINGS, "sheet") is None


def test_a_window_that_was_found_is_that_of_the_measurement_and_as_uncertain_as_it_is(through_a_window):
    data, _ = through_a_window
    window = BelievedWindow(0.2, 0.02)
    changed = window.of(data)
    assert correlation_window(changed) == (0.2, "average")
    # What the mean over it changes grows with its square.
    assert window_uncertainty(changed) == pytest.approx(np.hypot(0.25, 0.2))
    assert BelievedWindow.read(changed.attrs) == window and BelievedWindow.read(data.attrs) is None
    observations = field_problem(changed, SETTINGS).observations
    assert observations.window == 0.2 and observations.believed_window == window
