"""Noise is believed as far as the identified field bears it out; by a factor of three it costs a warning."""

import functools

import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.data.believed_noise import BelievedNoise, NoiseSource
from hypernode.identification.gauss_newton import descend
from hypernode.identification.problem import field_problem
from hypernode.identification.refuted_noise import refuted_noise
from hypernode.identification.settings import STRATEGY
from hypernode.identification.strategy import identify
from hypernode.mechanics.loads import make_load
from hypernode.stages.as_identified import problem_as_identified
from tests.sheets import believed, observed_coarsely, sheet, square

NOISE, SMALL = 1e-3, 3e-4
SETTINGS = Constrained(terms=["I1_squared"], isotropic_terms=[], further_terms=[], iterations=12, posterior_samples=0)


@functools.cache
def plain(factor):
    """(a homogeneous noisy sheet believed to be noisier by a factor, the field that is identified with that)."""
    data = sheet(10, lambda X: np.zeros(len(X)), make_load("equibiaxial", [1.1]), noise=NOISE)[0]
    data = believed(data, factor * NOISE)
    return data, descend(field_problem(data, SETTINGS), SETTINGS, "plain", None, (), 1e-3)


def told_by_frames(data, noise):
    return data.assign({f"frames_{key}": 0.0 * data[key] + noise for key in ("noise_scatter", "noise_level")})


def refuted(factor, by_frames=None):
    data, found = plain(factor)
    return refuted_noise(found, data if by_frames is None else told_by_frames(data, by_frames))


def test_noise_that_is_right_is_not_refuted_whatever_frames_tell():
    assert refuted(1.0) is None
    assert refuted(1.0, by_frames=4.0 * NOISE) is None, "the field leaves less than frames say"
    assert refuted(1.0, by_frames=NOISE / 4.0) is None, "frames do not see what is smooth"


def test_noise_far_above_what_a_field_leaves_is_what_it_leaves():
    found = refuted(4.0)
    assert found.source is NoiseSource.MEASUREMENT
    assert found.factor == pytest.approx(0.25, rel=0.15)


def test_frames_that_the_field_bears_out_tell_how_errors_are_shared_as_well():
    assert refuted(4.0, by_frames=NOISE) == BelievedNoise(NoiseSource.FRAMES)
    assert refuted(4.0, by_frames=1.6 * NOISE).source is NoiseSource.MEASUREMENT


def test_noise_is_larger_than_stated_only_where_frames_and_field_agree():
    assert refuted(0.25) is None, "what is missed may be the law's"
    assert refuted(0.25, by_frames=NOISE) == BelievedNoise(NoiseSource.FRAMES)
    assert refuted(0.25, by_frames=2.0 * NOISE) is None
    assert refuted(0.25, by_frames=np.nan) is None


@pytest.mark.slow
@pytest.mark.parametrize("factor", [4.0, 0.25])
def test_a_field_does_not_depend_on_a_noise_that_the_test_refutes(factor):
    noisy = sheet(12, square, make_load("biaxial", [[1.05, 1.04], [1.1, 1.06]]), noise=NOISE)[0]
    right = identify(noisy, SETTINGS, "right")
    wrong = told_by_frames(believed(noisy, factor * NOISE), NOISE)
    found = identify(wrong, SETTINGS, "wrong")
    np.testing.assert_allclose(found.params[:, 0], right.params[:, 0], atol=0.03)
    assert found.misfits["displacement"] == pytest.approx(right.misfits["displacement"], rel=0.1)
    # Whoever asks the field later takes the noise that it was identified with.
    problem = found.problem
    kept = wrong.assign_attrs(
        displacement_sigma=problem.sigma,
        noise_rules_displacements="true",
        layered=0,
        **problem.observations.believed_noise.stored(),
    )
    again, _ = problem_as_identified(wrong, kept, SETTINGS, problem.basis, 1)
    assert again.sigma == pytest.approx(problem.sigma, rel=1e-12)


def test_points_that_a_window_makes_uncertain_do_not_refute_the_noise_of_the_others():
    """Beside interfaces a moving average is exact, and less is left than engines would leave."""
    data, _ = observed_coarsely(12, square, make_load("equibiaxial", [1.1, 1.2]), 0.4)
    random = np.random.default_rng(3).normal(0.0, SMALL, data["u_measured"].shape)
    data = believed(data.assign(u_measured=data["u_measured"] + random), SMALL).assign_attrs(window_uncertainty=0.25)
    found = descend(field_problem(data, SETTINGS), SETTINGS, "seen", None, (), 1e-3)
    observations = found.problem.observations
    assert observations.scatter * observations.sigma < STRATEGY.noise_refuted * SMALL
    assert refuted_noise(found, data) is None
