"""Laminates of two materials, with the derivatives that a descent of interfaces needs.

The sides of a plane of normal N, of which the first has the share c, deform as

F_A = F + (1 - c) a x N,   F_B = F - c a x N,

with the jump a at which tractions agree, (P_A - P_B) N = 0. The stress is c P_A + (1 - c) P_B (Kabel, Merkert and
Schneider, Use of composite voxels in FFT-based homogenization, 2015). The dependence of the jump on all other variables
follows from the implicit function theorem.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from hypernode.identification import budgets, numerics
from hypernode.identification.points import Points


class Jumps(NamedTuple):
    """Jumps at which tractions agree, and how they follow the mean deformation gradient.

    Attributes:
        F: mean deformation gradient [i, J, point].
        jump: [k, point].
        by_F: its derivative [k, i, J, point].
    """

    F: Float[np.ndarray, "2 2 point"]
    jump: Float[np.ndarray, "2 point"]
    by_F: Float[np.ndarray, "2 2 2 point"]

    def near(self, F, share, normal) -> Float[np.ndarray, "2 point"]:
        """Jumps under another F to first order; none where a side would lose most of its area."""
        jump = self.jump + np.einsum("kiJn,iJn->kn", self.by_F, F - self.F)
        areas = [_area(side) for side in _sides(F, share, jump, normal)]
        return np.where(np.minimum(*areas) > (1.0 - numerics.LAMINATE_NEAREST) * _area(F), jump, 0.0)


class LaminateStress(NamedTuple):
    """Stress of layers [i, J, point] and its derivatives; the last four only where they were asked for.

    The derivative by the normal [i, J, k, point] is that of all vectors, of which only turning ones change the stress.
    """

    jumps: Jumps
    P: Float[np.ndarray, "2 2 point"]
    by_F: Float[np.ndarray, "2 2 2 2 point"]
    by_first: Float[np.ndarray, "2 2 parameter point"] | None
    by_second: Float[np.ndarray, "2 2 parameter point"] | None
    by_share: Float[np.ndarray, "2 2 point"] | None
    by_normal: Float[np.ndarray, "2 2 2 point"] | None


def laminate(
    points: Points, F, first, second, share, normal, with_parameters: bool, near: Jumps | None = None
) -> LaminateStress:
    """The stress of layers under the mean deformation gradient F.

    Args:
        F: [i, J, point].
        first, second: parameters of both sides (parameter, point).
        share: of the first side (point,).
        normal: of the plane (2, point).
        with_parameters: whether derivatives by parameters, share and normal are wanted.
        near: jumps of the same layers under an F near this one.
    """
    c, N = share, normal
    begun = np.zeros_like(normal) if near is None else near.near(F, share, normal)
    a = _jump(points, F, first, second, share, normal, begun)
    F_A, F_B = _sides(F, c, a, N)
    if with_parameters:
        P_A, A, D_A = points.all(F_A, first)
        P_B, B, D_B = points.all(F_B, second)
    else:
        (P_A, A), (P_B, B) = points.stress(F_A, first), points.stress(F_B, second)
    stiffness = _across(c, A, B, N)
    mean, difference = c * A + (1.0 - c) * B, A - B
    #: How the mean stress answers to the jump [i, J, k], and how the gap of tractions answers to F [i, k, L].
    to_jump = c * (1.0 - c) * np.einsum("iJkLn,Ln->iJkn", difference, N)
    of_F = np.einsum("iJkLn,Jn->ikLn", difference, N)

    def closing(gap_by):
        """How the jump answers to what changes the gap of tractions [k, ..., point]."""
        return -_solved(stiffness, gap_by.reshape(2, -1, gap_by.shape[-1])).reshape(gap_by.shape)

    def through_jump(gap_by):
        """What a change of the gap of tractions makes of the stress, as the jump closes it again."""
        shape = gap_by.shape
        jump = closing(gap_by).reshape(2, -1, shape[-1])
        return np.einsum("iJkn,kmn->iJmn", to_jump, jump).reshape(2, 2, *shape[1:])

    P = c * P_A + (1.0 - c) * P_B
    by_F, jumps = mean + through_jump(of_F), Jumps(F, a, closing(of_F))
    if not with_parameters:
        return LaminateStress(jumps, P, by_F, None, None, None, None)
    by_first = c * D_A + through_jump(np.einsum("iJpn,Jn->ipn", D_A, N))
    by_second = (1.0 - c) * D_B - through_jump(np.einsum("iJpn,Jn->ipn", D_B, N))
    across = a[:, None] * N[None]
    gap_by_share = -np.einsum("ikLn,kLn->in", of_F, across)
    by_share = P_A - P_B - np.einsum("iJkLn,kLn->iJn", mean, across)
    by_share = by_share + through_jump(gap_by_share[:, None])[:, :, 0]
    gap_by_normal = np.einsum("iJkLn,kn,Jn->iLn", (1.0 - c) * A + c * B, a, N) + P_A - P_B
    by_normal = c * (1.0 - c) * np.einsum("iJkLn,kn->iJLn", difference, a) + through_jump(gap_by_normal)
    return LaminateStress(jumps, P, by_F, by_first, by_second, by_share, by_normal)


def _sides(F, c, a, N):
    """Deformation gradients of both sides of a jump."""
    across = a[:, None] * N[None]
    return F + (1.0 - c) * across, F - c * across


def _jump(points: Points, F, first, second, share, normal, begun) -> Float[np.ndarray, "2 point"]:
    """The jump at which tractions agree: the minimum of the energy of both sides, which is convex in it.

    Steps of Newton's method end before a side is turned inside out; points whose jump is found take no part in the
    next ones.

    Args:
        begun: jump from which the first step goes.
    """
    jump, open_ = begun.copy(), np.arange(len(share))
    for _ in range(budgets.LAMINATE_STEPS):
        c, N, a, mean = share[open_], normal[:, open_], jump[:, open_], F[..., open_]
        F_A, F_B = _sides(mean, c, a, N)
        (P_A, A), (P_B, B) = points.stress(F_A, first[:, open_]), points.stress(F_B, second[:, open_])
        change = -_solved(_across(c, A, B, N), np.einsum("iJn,Jn->in", P_A - P_B, N))
        # Areas change with the jump in proportion.
        falls = (np.stack([-(1.0 - c), c]) * _area_by_jump(mean, change, N)) / np.stack([_area(F_A), _area(F_B)])
        jump[:, open_] = a + change * np.minimum(
            1.0, numerics.LAMINATE_NEAREST / np.maximum(falls.max(axis=0), numerics.LAMINATE_NEAREST)
        )
        open_ = open_[np.sqrt((change**2).sum(axis=0)) > numerics.LAMINATE_TOLERANCE]
        if not len(open_):
            break
    return jump


def _area(F):
    """Determinant at every point."""
    return F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0]


def _area_by_jump(F, a, N):
    """By how much a x N, added to F, changes its determinant."""
    return (F[1, 1] * N[0] - F[1, 0] * N[1]) * a[0] + (F[0, 0] * N[1] - F[0, 1] * N[0]) * a[1]


def _across(c, A, B, N):
    """Derivative [i, k] of the gap of tractions by the jump."""
    return np.einsum("iJkLn,Jn,Ln->ikn", (1.0 - c) * A + c * B, N, N)


def _solved(matrix, right):
    """x of matrix x = right at every point, two by two; right (2, ..., point)."""
    (a, b), (c, d) = matrix
    determinant = a * d - b * c
    return np.stack([(d * right[0] - b * right[1]) / determinant, (a * right[1] - c * right[0]) / determinant])
