"""Closed-form laws of a phase: the one that made its stresses is found, with its parameters, and how sure they are."""

import numpy as np
import pytest

from hypernode.export.choice import candidates
from hypernode.export.curves import SURE, Curves
from hypernode.export.fitting import law_components
from hypernode.export.laws import LAWS
from hypernode.mechanics.modes import mode_gradients

F = mode_gradients([1.1, 1.2, 1.3, 1.4]).reshape(-1, 2, 2)
TRUE = {
    "neo-Hookean": [0.7],
    "Mooney-Rivlin": [0.3, 0.15],
    "compressible neo-Hookean": [0.7, 1.4],
    "Demiray": [0.5, 1.2],
    "Yeoh": [0.3, -0.06, 0.08],
    "Gasser-Ogden-Holzapfel": [0.2, 0.3, 1.5, 0.12, 30.0],
}


def curves(stress, deviations=None):
    none = np.zeros((0, len(F), 3))
    return Curves(
        phase=0,
        cells=np.arange(1),
        share=1.0,
        modes=("mode",) * len(F),
        F=F,
        by_cell=stress[None],
        deviations=none if deviations is None else deviations,
    )


def stress_of(law):
    return law_components(law, F, np.array(TRUE[law.name]))


def noisy(count):
    """Neo-Hookean curves whose stresses are as uncertain as they are said to be."""
    stress, random = stress_of(LAWS[0]), np.random.default_rng(0)
    scale = SURE * np.linalg.norm(stress, axis=1, keepdims=True)
    return [curves(stress + scale * random.normal(size=stress.shape)) for _ in range(count)]


def with_posterior():
    """A Mooney-Rivlin curve, and the relative changes of its parameters in eight posterior samples."""
    stress, truth = stress_of(LAWS[1]), np.array(TRUE["Mooney-Rivlin"])
    changes = 0.03 * np.random.default_rng(1).normal(size=(8, 2))
    samples = [law_components(LAWS[1], F, truth * (1.0 + change)) - stress for change in changes]
    return curves(stress, np.stack(samples)), changes


@pytest.fixture(scope="module")
def found():
    """Candidates for exact stresses of every law, twenty noisy ones, and one with posterior samples."""
    return candidates([*(curves(stress_of(law)) for law in LAWS), *noisy(20), with_posterior()[0]])


def test_the_law_that_made_the_stresses_is_chosen_with_its_parameters(found):
    for law, ranked in zip(LAWS, found[: len(LAWS)], strict=True):
        assert ranked[0].law is law
        np.testing.assert_allclose(ranked[0].params, TRUE[law.name], rtol=1e-4)
        assert ranked[0].misfit < 1e-6


def test_laws_that_hold_the_true_one_miss_as_little_and_lose_by_their_parameters(found):
    neo_hookean = {each.law.name: each for each in found[0]}
    for name in ("Mooney-Rivlin", "Yeoh", "Demiray"):
        assert neo_hookean[name].misfit < 1e-3
        extra = len(neo_hookean[name].params) - 1
        assert neo_hookean[name].criterion >= neo_hookean["neo-Hookean"].criterion + 0.9 * extra * np.log(3 * len(F))


def test_noise_seldom_chooses_a_richer_law_and_the_modulus_scatters_as_is_said(found):
    ranked = found[len(LAWS) : -1]
    assert sum(each[0].law is LAWS[0] for each in ranked) >= 15
    plain = [next(each for each in candidates if each.law is LAWS[0]) for candidates in ranked]
    scatter, said = np.std([each.params[0] for each in plain], ddof=1), np.mean([each.deviation[0] for each in plain])
    # The standard deviation of twenty is known to a sixth.
    assert 0.6 * said < scatter < 1.5 * said


def test_standard_deviations_are_the_spread_of_fits_to_posterior_samples(found):
    fitted = next(each for each in found[-1] if each.law is LAWS[1])
    spread = np.array(TRUE["Mooney-Rivlin"]) * with_posterior()[1].std(axis=0, ddof=1)
    np.testing.assert_allclose(fitted.deviation, spread, rtol=1e-6)


def test_the_thickness_of_a_compressible_sheet_is_free_of_stress():
    """The plane law is that of the solid, whose P33 = mu (t - 1/t) + lambda ln (J t) / t vanishes."""
    mu, la = TRUE["compressible neo-Hookean"]
    J, t = np.linalg.det(F), np.ones(len(F))
    for _ in range(60):
        t = t - (mu * (t - 1.0 / t) + la * np.log(J * t) / t) / (mu * (1.0 + t**-2) + la * (1.0 - np.log(J * t)) / t**2)
    cofactor = np.stack([np.stack([F[:, 1, 1], -F[:, 1, 0]], -1), np.stack([-F[:, 0, 1], F[:, 0, 0]], -1)], 1)
    P = mu * F + ((la * np.log(J * t) - mu) / J)[:, None, None] * cofactor
    wanted = np.stack([P[:, 0, 0], P[:, 1, 1], (P[:, 0, 1] + P[:, 1, 0]) / np.sqrt(2.0)], axis=1)
    np.testing.assert_allclose(stress_of(LAWS[2]), wanted, atol=1e-12)
