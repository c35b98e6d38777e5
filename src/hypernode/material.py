"""The identified (or true) material of a sheet as three functions of position and deformation."""

import dataclasses
import json
from functools import partial
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import xarray as xr
from jaxtyping import Array, Float

from hypernode.basis_file import basis_field
from hypernode.config import Frequencies
from hypernode.mechanics.kinematics import REFERENCE, Invariants, invariants
from hypernode.mechanics.materials import energy_density, energy_derivatives
from hypernode.mechanics.stress import first_piola_kirchhoff
from hypernode.networks.node_material import NodeMaterial
from hypernode.networks.weights import from_arrays
from hypernode.storage.netcdf import StorageError, read, units_of

#: Gauss-Legendre points of the integral that turns dPsi/dI into an energy.
ENERGY_POINTS = 16


def node_stress(
    material: NodeMaterial, F: Float[Array, "2 2 ... point"], node_params: Float[Array, "size point"]
) -> Float[Array, "2 2 ... point"]:
    """P[i, J, ...] of a neural-ODE material (equation ``Node_constitutive_predicting``)."""
    angle = material.fibre_angle(node_params)
    return first_piola_kirchhoff(F, material.energy_derivatives(invariants(F, angle), node_params), angle)


def node_energy(
    material: NodeMaterial, F: Float[Array, "2 2 ... point"], node_params: Float[Array, "size point"]
) -> Float[Array, "... point"]:
    """Energy density of a neural-ODE material, integrated from its derivatives.

    Along the straight line from the undeformed invariants: Psi is a function of them, so any path would do.
    """
    points, weights = np.polynomial.legendre.leggauss(ENERGY_POINTS)
    I = invariants(F, material.fibre_angle(node_params))

    def along(s):
        between = Invariants(*(r + s * (v - r) for r, v in zip(REFERENCE, I, strict=True)))
        slope = material.energy_derivatives(between, node_params)
        return sum(d * (v - r) for d, v, r in zip(slope, I, REFERENCE, strict=True))

    at = jax.lax.map(along, jnp.asarray(0.5 * (points + 1.0), F.dtype))
    return jnp.tensordot(jnp.asarray(0.5 * weights, F.dtype), at, 1)


class Material:
    """A heterogeneous hyperelastic sheet.

    Attributes:
        units: what ``stress`` and ``energy`` (per reference volume) and ``length`` mean.
    """

    def __init__(self, params_at, stress, energy, units: dict[str, str]):
        self._params_at, self.units = params_at, units
        self._stress, self._energy = jax.jit(stress), jax.jit(energy)
        self._tangent = jax.jit(partial(_tangent, stress))

    def _evaluate(self, function, X, F):
        """``function`` of every state F [..., n, i, J], one after the other: it is compiled once for any number."""
        X, F = jnp.asarray(X), jnp.asarray(F)
        if X.ndim != 2 or X.shape[1] != 2 or F.shape[-3:] != (len(X), 2, 2):
            raise ValueError(f"X must be (n, 2) and F (..., n, 2, 2), not {X.shape} and {F.shape}")
        params = self._params_at(X)
        states = jnp.moveaxis(F.reshape(-1, *F.shape[-3:]), 1, -1)
        found = jnp.stack([jnp.moveaxis(function(state, params), -1, 0) for state in states])
        return found.reshape(*F.shape[:-2], *found.shape[2:])

    def energy(self, X: Float[Array, "n 2"], F: Float[Array, "... n 2 2"]) -> Float[Array, "... n"]:
        """Energy density Psi(X, F), zero at F = I.

        Args:
            X: positions, in the length unit of the test.
            F: in-plane deformation gradients, of one or more states of all positions.
        """
        return self._evaluate(self._energy, X, F)

    def stress(self, X: Float[Array, "n 2"], F: Float[Array, "... n 2 2"]) -> Float[Array, "... n 2 2"]:
        """First Piola-Kirchhoff stress P[..., n, i, J]; arguments as in :meth:`energy`."""
        return self._evaluate(self._stress, X, F)

    def tangent(self, X: Float[Array, "n 2"], F: Float[Array, "... n 2 2"]) -> Float[Array, "... n 2 2 2 2"]:
        """dP_iJ/dF_kL as [..., n, i, J, k, L]; arguments as in :meth:`energy`."""
        return self._evaluate(self._tangent, X, F)


def _tangent(stress, F, params):
    """dP_iJ/dF_kL as [i, J, k, L, n], by the derivative in each of the four directions at once."""
    _, derivative = jax.linearize(lambda F: stress(F, params), F)
    directions = jnp.broadcast_to(jnp.eye(4, dtype=F.dtype).reshape(4, 2, 2, 1), (4, *F.shape))
    return jnp.moveaxis(jax.vmap(derivative)(directions), 0, 2).reshape(2, 2, 2, 2, -1)


def nearest_cell(file: xr.Dataset):
    """X (point, 2) -> number of the cell whose centre is nearest."""
    from scipy.spatial import cKDTree

    tree = cKDTree(file["X"].values[file["cells"].values].mean(axis=1))
    return lambda X: tree.query(np.asarray(X))[1]


def mean_of_parts(law):
    """Stress or energy of cells as the mean of their parts, whose parameters are (parameter, part, point)."""
    # One after the other: the compiler gets a mean along a middle axis wrong at some sizes (docs/decisions/0020).
    return lambda F, params: sum(law(F, params[:, k]) for k in range(params.shape[1])) / params.shape[1]


def drawn_material(file: xr.Dataset) -> Material | None:
    """All draws of a constrained field as one material, or None where it has none.

    Its positions are the cell centres, once for each draw. Stress and energy are to first order in the draw's distance
    from the best field, as the draws themselves are: parameters that trade places are far apart one by one.
    """
    basis, best = basis_field(file)
    names = [f"draw.{name}" for name in basis.names]
    if names[0] not in file:
        return None
    draws = np.stack([file[name].values for name in names])
    change = np.moveaxis(draws - best[:, None], 1, 2)
    params = tuple(
        jnp.asarray(np.broadcast_to(each, change.shape).reshape(*best.shape[:2], -1))
        for each in (best[:, :, None], change)
    )

    def linear(law):
        """Of the best field, and its first-order change."""
        of_cells = mean_of_parts(law)

        def extended(F, params):
            value, change = jax.jvp(lambda p: of_cells(F, p), params[:1], params[1:])
            return value + change

        return extended

    return Material(lambda X: params, linear(basis.stress), linear(basis.energy), units_of(file))


def _convex_basis(file: xr.Dataset) -> Material:
    basis, params = basis_field(file)
    cell = nearest_cell(file)
    laws = mean_of_parts(basis.stress), mean_of_parts(basis.energy)
    return Material(lambda X: jnp.asarray(params[..., cell(X)]), *laws, units_of(file))


def _closed_form(file: xr.Dataset) -> Material:
    models = tuple(json.loads(file.attrs["models"]))
    values = {v.split(".", 1)[1]: file[v].values for v in file if v.startswith("material.")}
    cell = nearest_cell(file)

    def params_at(X):
        at = cell(X)
        return {key: jnp.asarray(value[at]) for key, value in values.items()}

    def stress(F, params):
        angle = params.get("fibre_angle", jnp.zeros(()))
        return first_piola_kirchhoff(F, energy_derivatives(models, invariants(F, angle), params), angle)

    def energy(F, params):
        return energy_density(models, invariants(F, params.get("fibre_angle", jnp.zeros(()))), params)

    return Material(params_at, stress, energy, units_of(file))


def parameter_field(file: xr.Dataset):
    """(material, X -> node_params[size, point]) of a file that holds a hyper-network."""
    material = NodeMaterial(
        **{k: tuple(v) if isinstance(v, list) else v for k, v in json.loads(file.attrs["node"]).items()}
    )
    settings = Frequencies.model_validate_json(file.attrs["hypernetwork"])
    network = from_arrays(settings, 0, material.size, file, "hypernetwork")
    lower = jnp.asarray(file["corners"].values[0], jnp.float32)
    length = float(file.attrs["length_scale"])
    return material, lambda X: network((jnp.asarray(X, jnp.float32) - lower) / length).T


def _node(file: xr.Dataset) -> Material:
    material, params_at = parameter_field(file)
    units = material.units_as_data

    def compiled_once(function):
        """The units of a material are arguments, so that materials of one architecture share what is compiled."""

        def of_units(F, params):
            units, node_params = params
            return function(dataclasses.replace(material, **units), F, node_params)

        return of_units

    return Material(
        lambda X: (units, params_at(X)), compiled_once(node_stress), compiled_once(node_energy), units_of(file)
    )


_KINDS = {"closed_form": _closed_form, "convex_basis": _convex_basis, "node": _node}


def material_of(file: xr.Dataset) -> Material:
    """The material field of an opened result file that holds one."""
    return _KINDS[file.attrs["material_kind"]](file)


def load_material(path: str | Path) -> Material:
    """The material field stored in a result file, identified or true.

    Args:
        path: ``material.nc`` or ``constrained.nc`` of a run, or ``true_material.nc`` of a synthetic case.

    Raises:
        StorageError: the file is missing, damaged, or holds no material.
    """
    file = read(path)
    if file.attrs.get("material_kind") not in _KINDS:
        raise StorageError(f"{path}: holds no material; load material.nc of a run or true_material.nc of a case")
    return material_of(file)
