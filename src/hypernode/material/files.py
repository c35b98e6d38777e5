"""Materials read from the files that hold them."""

import dataclasses
import json
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import xarray as xr

from hypernode.config.methods import Frequencies
from hypernode.material.basis_file import basis_field
from hypernode.material.domain_file import domain_of
from hypernode.material.field import Material
from hypernode.material.laws import mean_of_subcells, node_energy, node_stress
from hypernode.material.lines import like_its_point
from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.closed_forms import energy_density, energy_derivatives
from hypernode.mechanics.kinematics import invariants
from hypernode.mechanics.stress import first_piola_kirchhoff
from hypernode.networks.weights import from_arrays
from hypernode.storage.netcdf import StorageError, read, units_of

#: Variables of a constrained field that say where materials are within its cells.
LINES = ("material_label", "interface_distance")


def nearest_cell(file: xr.Dataset):
    """X (point, 2) -> number of the cell whose centre is nearest."""
    from scipy.spatial import cKDTree

    tree = cKDTree(file["X"].values[file["cells"].values].mean(axis=1))
    return lambda X: tree.query(np.asarray(X))[1]


def lines_of(file: xr.Dataset) -> dict[str, np.ndarray] | None:
    """What lines make of the cells of a constrained field; None where it has no lines.

    Returns:
        ``cell_middle``, ``cell_sides`` (cell, 2), ``cell_label`` (cell,) and ``line_distances`` (line, cell, 4), as
        :func:`~hypernode.material.lines.like_its_point` takes them.
    """
    if "interface_distance" not in file:
        return None
    cells = file["cells"].values
    corners = file["X"].values[cells]
    return {
        "cell_middle": corners.mean(axis=1),
        "cell_sides": np.ptp(corners, axis=1),
        "cell_label": file["material_label"].values,
        "line_distances": file["interface_distance"].values[:, cells],
    }


def posterior_material(file: xr.Dataset) -> Material | None:
    """All posterior samples of a constrained field as one material, or None where it has none.

    Its positions are the cell centres, once for each sample. Stress and energy are to first order in the sample's
    distance from the best field, as the samples themselves are: parameters that trade places are far apart one by one.
    """
    basis, best = basis_field(file)
    names = [f"posterior.{name}" for name in basis.names]
    if names[0] not in file:
        return None
    samples = np.stack([file[name].values for name in names])
    change = np.moveaxis(samples - best[:, None], 1, 2)
    params = tuple(
        jnp.asarray(np.broadcast_to(each, change.shape).reshape(*best.shape[:2], -1))
        for each in (best[:, :, None], change)
    )

    def linear(law):
        """Of the best field, and its first-order change."""
        of_cells = mean_of_subcells(law)

        def extended(F, params):
            value, change = jax.jvp(lambda p: of_cells(F, p), params[:1], params[1:])
            return value + change

        return extended

    return Material(lambda X: params, linear(basis.stress), linear(basis.energy), units_of(file))


def _convex_basis(file: xr.Dataset) -> Material:
    basis, params = basis_field(file)
    laws = mean_of_subcells(basis.stress), mean_of_subcells(basis.energy)
    cell, lines = nearest_cell(file), lines_of(file)

    def at(X):
        if lines is None:
            return cell(X)
        own, X = cell(X), np.asarray(X)
        place = (X - lines["cell_middle"][own]) / lines["cell_sides"][own]
        return like_its_point(own, place, lines["line_distances"], lines["cell_label"])

    return Material(lambda X: jnp.asarray(params[..., at(X)]), *laws, units_of(file))


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


def node_material(file: xr.Dataset) -> NodeMaterial:
    """The material of a point of a file that holds a hyper-network."""
    stored = json.loads(file.attrs["node"])
    return NodeMaterial(**{k: tuple(v) if isinstance(v, list) else v for k, v in stored.items()})


def parameter_field(file: xr.Dataset):
    """(material, X -> node_params[size, point]) of a file that holds a hyper-network."""
    material = node_material(file)
    settings = Frequencies.model_validate_json(file.attrs["hypernetwork"])
    network = from_arrays(settings, 0, material.size, file, "hypernetwork")
    lower = jnp.asarray(file["corners"].values[0], jnp.float32)
    length = float(file.attrs["length_scale"])
    return material, lambda X: network((jnp.asarray(X, jnp.float32) - lower) / length).T


def _homogenised(file: xr.Dataset) -> Material:
    params = jnp.asarray(file["node_params"].values, jnp.float32)[:, None]
    return _of_nodes(file, node_material(file), lambda X: jnp.broadcast_to(params, (len(params), len(X))))


def _node(file: xr.Dataset) -> Material:
    return _of_nodes(file, *parameter_field(file))


def _of_nodes(file: xr.Dataset, material: NodeMaterial, params_at) -> Material:
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


_KINDS = {"closed_form": _closed_form, "convex_basis": _convex_basis, "homogenised": _homogenised, "node": _node}


def material_of(file: xr.Dataset) -> Material:
    """The material field of an opened result file that holds one."""
    return _KINDS[file.attrs["material_kind"]](file)


def load_material(path: str | Path) -> Material:
    """The material field stored in a result file, identified or true.

    An identified one warns once where it is asked for deformations that its test has not seen (``seen``).

    Args:
        path: ``material.nc`` or ``constrained.nc`` of a run, or ``true_material.nc`` of a synthetic case.

    Raises:
        StorageError: the file is missing, damaged, or holds no material.
    """
    file = read(path)
    if file.attrs.get("material_kind") not in _KINDS:
        raise StorageError(f"{path}: holds no material; load material.nc of a run or true_material.nc of a case")
    material = material_of(file)
    material.seen = domain_of(file)
    return material
