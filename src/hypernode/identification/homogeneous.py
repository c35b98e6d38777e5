"""The homogeneous start of a descent, and the misfit of the forces with one material of the basis."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares

from hypernode.fem.gradient import deformation_gradient
from hypernode.identification import budgets, numerics, priors
from hypernode.identification.equilibrium import FieldEquilibrium
from hypernode.identification.observations import Observations
from hypernode.identification.points import Points
from hypernode.mechanics.convex_basis import FIBRE_VECTOR, ConvexBasis

#: Misfits of 1 % count as one.
PERCENT = 100.0


@dataclass(frozen=True)
class Homogeneous:
    """One material for the whole sheet.

    Attributes:
        params: parameters of the basis (parameter,), fitted to all load cases, with as few terms as needed.
        force_misfit: smallest relative misfit of each load case's mean stresses (load case,) by a fit to it alone. The
            rest is an error of the model.
    """

    params: Float[np.ndarray, " parameter"]
    force_misfit: Float[np.ndarray, " case"]


def fit_homogeneous(observations: Observations, basis: ConvexBasis, equilibrium: FieldEquilibrium) -> Homogeneous:
    """Fit one material to the mean stresses of the mean deformation.

    Clamps deform even a homogeneous sheet non-uniformly. This effect is computed and corrected, unless the grid is cut
    out of a larger sheet and the clamps are far away.
    """
    loading, mean_F, points = observations.loading, observations.mean_F, Points(basis)
    target, known = np.moveaxis(loading.P_average, 0, -1), np.moveaxis(loading.measured, 0, -1)
    start = basis.start
    start[0] = np.log(numerics.FIRST_LEVEL * loading.scale.max())

    def everywhere(params):
        return np.tile(params[:, None], mean_F.shape[2])

    def value(params, target):
        return (points.stress_alone(mean_F, everywhere(params)) - target) / loading.scale

    def derivative(params):
        return np.moveaxis(points.by_parameters(mean_F, everywhere(params)) / loading.scale, 2, 3)

    def measured(values, steps):
        return values[:, :, steps][known[:, :, steps]]

    # Fibres begin above zero, where they have a gradient, but the plainest material has none.
    plainest = np.array([0.0 if key in FIBRE_VECTOR else p for key, p in zip(basis.names, start, strict=True)])

    def fit(ridge, steps, target):
        ridges = ridge * np.eye(len(start))[1:]
        return least_squares(
            lambda p: np.concatenate([PERCENT * measured(value(p, target), steps), ridges @ (p - plainest)]),
            start,
            jac=lambda p: np.concatenate([PERCENT * measured(derivative(p), steps), ridges]),
        ).x

    found = fit(priors.STRONG_RIDGE, slice(None), target)
    clamped = loading.constrained.all(axis=2).any()
    straight = target
    for _ in range(budgets.BENDING_ROUNDS if clamped and not observations.cut else 0):
        bent = _bending(equilibrium, basis, found)
        if bent is None:
            break
        straight = target - bent
        found = fit(priors.STRONG_RIDGE, slice(None), straight)
    cases = [loading.load_case == k for k in range(loading.load_case.max() + 1)]
    fits = [(fit(priors.WEAK_RIDGE, steps, straight), steps) for steps in cases]
    missed = [measured(value(params, straight), steps) for params, steps in fits]
    # A load case without forces misses none.
    closest = [np.sqrt(np.mean(each**2)) if len(each) else 0.0 for each in missed]
    return Homogeneous(found, np.array(closest))


def _bending(equilibrium: FieldEquilibrium, basis: ConvexBasis, params) -> Float[np.ndarray, "2 2 step"] | None:
    """Mean stress of a homogeneous sheet beyond that of its mean deformation, or None without equilibrium."""
    mesh = equilibrium.mesh
    everywhere = np.tile(params, (len(mesh.cells), 1))
    states = equilibrium.states(everywhere, equilibrium.extension(everywhere))
    if states is None:
        return None
    area = mesh.areas / mesh.areas.sum()
    P = [np.einsum("ai,aJ->iJ", s.force.reshape(-1, 2), mesh.nodes) / mesh.areas.sum() for s in states]
    F = np.einsum("scij,c->ijs", deformation_gradient(mesh, np.stack([s.u for s in states])), area)
    return np.stack(P, axis=-1) - np.asarray(basis.stress(F, params[:, None]))
