"""Cells of two layers: tractions agree, and derivatives are those of the stress."""

import numpy as np
import pytest

from hypernode.identification.laminates import laminate
from hypernode.identification.points import Points
from hypernode.mechanics.convex_basis import ConvexBasis

LAW = ConvexBasis(("I1_squared", "I2"), 0.5)
POINTS = Points(LAW)
NUMBER = 7
RANDOM = np.random.default_rng(2)
F = np.eye(2)[:, :, None] + 0.1 * RANDOM.normal(size=(2, 2, NUMBER))
FIRST = np.tile([[0.4], [0.3], [0.2]], (1, NUMBER))
SECOND = np.tile([[-1.0], [0.1], [0.4]], (1, NUMBER))
SHARE = RANDOM.uniform(0.1, 0.9, NUMBER)
ANGLE = RANDOM.uniform(0.0, np.pi, NUMBER)
NORMAL = np.stack([np.cos(ANGLE), np.sin(ANGLE)])


def stress(F=F, first=FIRST, second=SECOND, share=SHARE, normal=NORMAL):
    return laminate(POINTS, F, first, second, share, normal, False).P


def difference(name, given, along):
    step = 1e-6
    return (stress(**{name: given + step * along}) - stress(**{name: given - step * along})) / (2.0 * step)


def test_layers_of_one_material_are_that_material():
    np.testing.assert_allclose(stress(second=FIRST), POINTS.stress(F, FIRST)[0], atol=1e-12)


def test_jumps_begun_near_those_of_another_deformation_end_at_the_same():
    known = laminate(POINTS, F, FIRST, SECOND, SHARE, NORMAL, False).jumps
    for size in (1e-3, 0.2):
        other = F + size * RANDOM.normal(size=F.shape)
        near = laminate(POINTS, other, FIRST, SECOND, SHARE, NORMAL, False, known)
        np.testing.assert_allclose(near.P, stress(other), rtol=1e-9, atol=1e-12)
    moved = known.near(F + 1e-6 * (other - F), SHARE, NORMAL) - known.jump
    exact = laminate(POINTS, F + 1e-6 * (other - F), FIRST, SECOND, SHARE, NORMAL, False).jumps.jump - known.jump
    np.testing.assert_allclose(moved, exact, atol=1e-3 * np.abs(moved).max())


def test_a_jump_that_would_turn_a_side_inside_out_is_no_beginning():
    known = laminate(POINTS, F, FIRST, SECOND, SHARE, NORMAL, False).jumps
    far = known._replace(jump=known.jump - 20.0 * NORMAL)
    assert not far.near(F, SHARE, NORMAL).any()
    np.testing.assert_allclose(laminate(POINTS, F, FIRST, SECOND, SHARE, NORMAL, False, far).P, stress(), rtol=1e-9)


def test_a_thin_soft_layer_carries_the_traction_of_a_stiff_one_at_any_jump():
    stretched, share = np.tile(np.diag([1.3, 1.2])[:, :, None], (1, NUMBER)), np.full(NUMBER, 1e-3)
    soft, stiff = FIRST - np.array([[3.0], [0.0], [0.0]]), FIRST + np.array([[1.0], [0.0], [0.0]])
    answer = laminate(POINTS, stretched, soft, stiff, share, NORMAL, False)
    of_stiff = POINTS.stress(stretched, stiff)[0]
    np.testing.assert_allclose(answer.P, of_stiff, rtol=0.02, atol=0.02 * np.abs(of_stiff).max())
    along = RANDOM.normal(size=(2, 2, 1))
    changed = (stress(stretched + 1e-6 * along, soft, stiff, share) - stress(stretched, soft, stiff, share)) / 1e-6
    predicted = np.einsum("iJkLn,kLm->iJn", answer.by_F, along)
    np.testing.assert_allclose(predicted, changed, rtol=1e-3, atol=1e-3 * np.abs(changed).max())


def test_stress_is_the_derivative_of_a_mean_energy_that_no_jump_lowers():
    """Of the energies of both sides at the jump that tractions choose, and at jumps near it."""

    def energy(a):
        across = a[:, None] * NORMAL[None]
        one = LAW.energy(F + (1.0 - SHARE) * across, FIRST)
        return np.asarray(SHARE * one + (1.0 - SHARE) * LAW.energy(F - SHARE * across, SECOND))

    def least():
        a, step = np.zeros((2, NUMBER)), 1e-4
        for _ in range(12):
            gradient = np.stack([(energy(a + d) - energy(a - d)) / (2.0 * step) for d in shifts(step)])
            hessian = np.array(
                [
                    [
                        (energy(a + d + e) - energy(a + d - e) - energy(a - d + e) + energy(a - d - e))
                        / (4.0 * step**2)
                        for e in shifts(step)
                    ]
                    for d in shifts(step)
                ]
            )
            a = a - np.linalg.solve(np.moveaxis(hessian, 2, 0), gradient.T[..., None])[..., 0].T
        return a

    def shifts(step):
        return [step * np.repeat(np.eye(2)[k][:, None], NUMBER, axis=1) for k in range(2)]

    across = least()[:, None] * NORMAL[None]
    one, _ = POINTS.stress(F + (1.0 - SHARE) * across, FIRST)
    other, _ = POINTS.stress(F - SHARE * across, SECOND)
    np.testing.assert_allclose(np.einsum("iJn,Jn->in", one - other, NORMAL), 0.0, atol=1e-5)
    np.testing.assert_allclose(stress(), SHARE * one + (1.0 - SHARE) * other, atol=1e-5)


@pytest.mark.parametrize("k", range(2))
@pytest.mark.parametrize("L", range(2))
def test_the_derivative_by_the_deformation_is_that_of_the_stress(k, L):
    along = np.zeros((2, 2, 1))
    along[k, L] = 1.0
    found = laminate(POINTS, F, FIRST, SECOND, SHARE, NORMAL, True).by_F[:, :, k, L]
    np.testing.assert_allclose(found, difference("F", F, along), atol=1e-8)


@pytest.mark.parametrize("parameter", range(3))
def test_derivatives_by_materials_and_share_are_those_of_the_stress(parameter):
    found = laminate(POINTS, F, FIRST, SECOND, SHARE, NORMAL, True)
    along = np.eye(3)[:, parameter : parameter + 1]
    np.testing.assert_allclose(found.by_first[:, :, parameter], difference("first", FIRST, along), atol=1e-8)
    np.testing.assert_allclose(found.by_second[:, :, parameter], difference("second", SECOND, along), atol=1e-8)
    np.testing.assert_allclose(found.by_share, difference("share", SHARE, 1.0), atol=1e-8)


def test_the_derivative_by_the_normal_is_that_of_a_line_that_turns():
    turned = np.stack([-NORMAL[1], NORMAL[0]])
    found = laminate(POINTS, F, FIRST, SECOND, SHARE, NORMAL, True).by_normal
    along = np.einsum("iJkn,kn->iJn", found, turned)
    np.testing.assert_allclose(along, difference("normal", NORMAL, turned), atol=1e-8)
    np.testing.assert_allclose(np.einsum("iJkn,kn->iJn", found, NORMAL), 0.0, atol=1e-12)
