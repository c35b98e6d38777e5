"""Files that an evaluation reads, as they would be opened."""

import json

import numpy as np
import xarray as xr

from hypernode.fem.mesh import EDGE_NAMES, Mesh, rectilinear
from hypernode.storage.netcdf import SYNTHETIC_UNITS


def square_mesh(cells: int) -> Mesh:
    lines = np.linspace(0.0, 1.0, cells + 1)
    return rectilinear(lines, lines)


def grid(mesh: Mesh) -> dict:
    return {
        "X": (("node", "i"), mesh.nodes),
        "cells": (("cell", "vertex"), mesh.cells),
        "corners": (("corner", "i"), np.stack([mesh.lower, mesh.upper])),
    }


def closed_form(mesh: Mesh, model: str, **parameters) -> xr.Dataset:
    """A true material of one model, each parameter one number or one a cell."""
    parameters = {"model": 0.0, **parameters}
    values = {
        f"material.{name}": ("cell", np.broadcast_to(value, len(mesh.cells)).astype(float))
        for name, value in parameters.items()
    }
    attributes = {
        "material_kind": "closed_form",
        "models": json.dumps([model]),
        "units": json.dumps(SYNTHETIC_UNITS),
    }
    return xr.Dataset(grid(mesh) | values, attrs=attributes)


def measurement(mesh: Mesh, F, edge_force, prescribed, thickness: float = 1.0, relaxation=1.0) -> xr.Dataset:
    """One load case with homogeneous deformations F (step, 2, 2) and the resultants of every edge (step, edge, 2)."""
    F = np.asarray(F, float)
    steps, H = len(F), F - np.eye(2)
    held = np.zeros((steps, len(EDGE_NAMES), 2))
    for edge, i in prescribed:
        held[:, EDGE_NAMES.index(edge), i] = 1.0
    return xr.Dataset(
        {
            **grid(mesh),
            "u_measured": (
                ("repeat", "load_step", "node", "i"),
                np.einsum("siJ,nJ->sni", H, mesh.nodes)[None],
            ),
            "load_case": ("load_step", np.zeros(steps, int)),
            "stretch": ("load_step", 1.0 + H.reshape(steps, 4).max(axis=1)),
            "H": (("load_step", "i", "J"), H),
            "edge_force": (("load_step", "edge", "i"), np.where(held > 0, edge_force, np.nan)),
            "relaxation": ("load_step", np.broadcast_to(relaxation, steps).astype(float)),
            "edge_constrained": (("load_step", "edge", "i"), held),
            "noise_level": (("load_step", "i"), np.zeros((steps, 2))),
            "relative_thickness": ("cell", np.ones(len(mesh.cells))),
        },
        attrs={"thickness": thickness, "outline": "edge"},
    )
