"""A test that nobody has done yet, as a measurement of nothing but its edges."""

import numpy as np
import xarray as xr

from hypernode.fem.mesh import EDGE_NAMES, rectilinear
from hypernode.mechanics.loads import RESULTANTS, Load


def planned_test(size: tuple[float, float, float], load: Load, cells: int) -> xr.Dataset:
    """The measurement that such a test would be, without points inside and without forces.

    Args:
        size: width, height and thickness of the sheet.
        load: how it is held and pulled.
        cells: along its longer side.
    """
    width, height, thickness = size
    step = max(width, height) / cells
    lines = [np.linspace(0.0, side, max(round(side / step), 2) + 1) for side in (width, height)]
    mesh, steps = rectilinear(*lines), len(load.H)
    edge = np.any([mesh.on_edge(name) for name in EDGE_NAMES], axis=0)
    u = np.where(edge[:, None], np.einsum("sij,nj->sni", load.H, mesh.nodes), np.nan)
    held, force = np.zeros((steps, len(EDGE_NAMES), 2)), np.full((steps, len(EDGE_NAMES), 2), np.nan)
    for name, component in load.constrained:
        held[:, EDGE_NAMES.index(name), component] = 1.0
    # Convention of a test without a load cell: a force of one.
    for i, J in RESULTANTS[load.kind]:
        force[:, EDGE_NAMES.index(("right", "top")[J]), i] = 1.0
    return xr.Dataset(
        {
            "X": (("node", "i"), mesh.nodes),
            "cells": (("cell", "vertex"), mesh.cells),
            "corners": (("corner", "i"), np.stack([mesh.lower, mesh.upper])),
            "u_measured": (("repeat", "load_step", "node", "i"), u[None]),
            "noise_level": (("load_step", "i"), np.zeros((steps, 2))),
            "noise_scatter": (("load_step", "i"), np.zeros((steps, 2))),
            "relative_thickness": (("cell",), np.ones(len(mesh.cells))),
            "load_case": (("load_step",), np.zeros(steps, int)),
            "stretch": (("load_step",), load.stretch),
            "H": (("load_step", "i", "J"), load.H),
            "edge_force": (("load_step", "edge", "i"), force),
            "relaxation": (("load_step",), np.ones(steps)),
            "edge_constrained": (("load_step", "edge", "i"), held),
        },
        attrs={
            **{"noise_uncertainty": 0.0, "force_uncertainty": 0.0, "force_gain_uncertainty": 0.0},
            **{"force_offset_uncertainty": 0.0, "correlation_window": 0.0, "thickness": thickness},
            **{"outline": "edge", "mesh": "finer", "forces": "assumed"},
        },
    )
