"""Opened result files of a small noisy test of an anisotropic sheet whose right half is stiffer."""

import dataclasses
import json

import jax
import numpy as np
import xarray as xr

from hypernode.config.methods import Frequencies
from hypernode.fem.mesh import EDGE_NAMES, Mesh
from hypernode.material.basis_file import basis_content
from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.networks.weights import make_network, to_arrays
from hypernode.storage.netcdf import SYNTHETIC_UNITS
from tests.evaluation.files import closed_form, grid, measurement, square_mesh
from tests.figures.data import verdict

STRETCHES = np.array([1.05, 1.1, 1.15])
NOISE = 1e-3
SAMPLES = 4
BASIS = ConvexBasis(("I1_squared", "I2", "fibre", "stiffening"), 0.3)
NODE = NodeMaterial(
    terms=("I1", "I2", "I1_I4v"), hidden=(3, 2), steps=2, invariant_scale=0.4, stress_scale=0.8, scaled=True
)
FIBRE_ANGLE = 0.5
COMMON = {"units": json.dumps(SYNTHETIC_UNITS)}


def right_half(mesh: Mesh) -> np.ndarray:
    return mesh.centres[:, 0] > 0.5


def basis_params(mesh: Mesh, subcells: int = 2) -> np.ndarray:
    """(parameter, subcell, cell) of a basis that is stiffer on the right and differs a little everywhere."""
    rng = np.random.default_rng(3)
    start = BASIS.start + np.where(np.array(BASIS.names) == "fibre_y", 0.2, 0.0)
    params = start[:, None, None] + rng.normal(0.0, 0.02, (len(start), subcells, len(mesh.cells)))
    params[0] += np.where(right_half(mesh), np.log(2.0), 0.0)
    return params


def constrained(mesh: Mesh) -> xr.Dataset:
    """An equilibrium field with posterior samples; its displacement is a little off the measured one."""
    params, rng = basis_params(mesh), np.random.default_rng(4)
    content, attributes = basis_content(BASIS, params)
    for name, values in zip(BASIS.names, params, strict=True):
        samples = values + rng.normal(0.0, 0.03, (SAMPLES, *values.shape))
        content[f"posterior.{name}"] = (("posterior_sample", "subcell", "cell"), samples)
    u = displacement(mesh) + rng.normal(0.0, NOISE, (len(STRETCHES), len(mesh.nodes), 2))
    content["u"] = (("load_step", "node", "i"), u)
    return xr.Dataset(grid(mesh) | content, attrs=COMMON | attributes)


def displacement(mesh: Mesh) -> np.ndarray:
    return (STRETCHES - 1.0)[:, None, None] * mesh.nodes


def hyper_network(mesh: Mesh) -> xr.Dataset:
    """A neural-ODE material whose weights change over the sheet."""
    settings = Frequencies(features=4, frequency_scale=1.0, widths=(6,))
    arrays = to_arrays(make_network(settings, 0, NODE.size, 0), "hypernetwork")
    # The last layer: a mean material, and what changes of it over the sheet.
    dims, bias = arrays["hypernetwork.layers.1.bias"]
    mean = np.array(NODE.initial_params(jax.random.key(0)))
    mean[-1] = FIBRE_ANGLE
    arrays["hypernetwork.layers.1.bias"] = dims, (bias + mean).astype(np.float32)
    dims, kernel = arrays["hypernetwork.layers.1.kernel"]
    arrays["hypernetwork.layers.1.kernel"] = dims, (0.3 * kernel).astype(np.float32)
    attributes = {"material_kind": "node", "node": json.dumps(dataclasses.asdict(NODE)), "length_scale": 1.0}
    return xr.Dataset(grid(mesh) | arrays, attrs=COMMON | attributes | {"hypernetwork": settings.model_dump_json()})


def truth(mesh: Mesh) -> xr.Dataset:
    stiffer = np.where(right_half(mesh), 2.0, 1.0)
    return closed_form(mesh, "goh", C10=0.5 * stiffer, k1=0.3 * stiffer, k2=1.0, kappa=0.1, fibre_angle=FIBRE_ANGLE)


def measured(mesh: Mesh) -> xr.Dataset:
    edges = np.ones((len(STRETCHES), len(EDGE_NAMES), 2)) * STRETCHES[:, None, None]
    held = [("left", 0), ("right", 0), ("bottom", 1), ("top", 1)]
    file = measurement(mesh, STRETCHES[:, None, None] * np.eye(2), edges, held)
    noise = {
        name: (("load_step", "i"), np.full((len(STRETCHES), 2), NOISE)) for name in ("noise_level", "noise_scatter")
    }
    return file.assign(noise).assign_attrs(load_cases=json.dumps(["equibiaxial"]), **COMMON)


def evaluation(mesh: Mesh, level: str = "pass", method: str = "m") -> xr.Dataset:
    """What a run is judged by, as far as an explorer reads it."""
    rng = np.random.default_rng(5)
    cells, steps = len(mesh.cells), len(STRETCHES)
    half = right_half(mesh).astype(int)
    force = np.ones((steps, len(EDGE_NAMES), 2)) * STRETCHES[:, None, None]
    by_cell = (("load_step", "cell"), rng.uniform(0.05, 0.1, (steps, cells)))
    fields = {
        "stretch": ("load_step", STRETCHES),
        "edge_force": (("load_step", "edge", "i"), np.where(np.eye(4, 2, dtype=bool), np.nan, force)),
        "edge_force_at_identified": (("load_step", "edge", "i"), 1.02 * force),
        "principal_strain_measured": by_cell,
        "principal_strain_identified": by_cell,
        "trace_P": ("cell", 1.0 + half),
        "trace_P_spread": ("cell", 0.05 * (1.0 + half)),
        "shape": ("cell", half),
        "phase_found": ("cell", half),
        "phase": ("cell", half),
        "shape_true": ("cell", half),
        "curve_location": (("location", "i"), np.array([[0.2, 0.5], [0.8, 0.5]])),
    }
    summary = {"largest_stretch": 1.2, "phases_found": 2, "ending": "converged", "spread": 0.05}
    attributes = {
        "run": json.dumps({"case": "half", "method": method}),
        "verdict": json.dumps(verdict(level)),
        "summary": json.dumps(summary),
        "load": "equibiaxial",
        "shape_stretch": 1.1,
    }
    return xr.Dataset(grid(mesh) | fields, attrs=COMMON | attributes)


def run_files(cells: int = 4, level: str = "pass", method: str = "m") -> dict[str, xr.Dataset]:
    """Everything that an explorer may read of a run."""
    mesh = square_mesh(cells)
    return {
        "evaluation": evaluation(mesh, level, method),
        "measurement": measured(mesh),
        "material": hyper_network(mesh),
        "constrained": constrained(mesh),
        "truth": truth(mesh),
    }
