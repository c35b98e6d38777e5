"""The measurement file of a sheet that other finite elements computed: a grid over all of it, and a load cell."""

from pathlib import Path

import numpy as np

from benchmarks.strangers.design import SIDE, THICKNESS, Sheet
from benchmarks.strangers.solve import Equilibria
from hypernode.fem.mesh import EDGE_NAMES, Mesh, rectilinear
from hypernode.mechanics.loads import make_load
from hypernode.storage.netcdf import EXPERIMENT_UNITS, write


def grid_of(sheet: Sheet) -> Mesh:
    """The camera's grid [mm]."""
    line = np.linspace(0.0, SIDE, sheet.points)
    return rectilinear(line, line)


def write_measurement(sheet: Sheet, equilibria: Equilibria, noise: float, path: Path) -> None:
    """Displacements with noise of a standard deviation [mm], forces with the errors of the sheet's load cell.

    The file has the true displacement too, ``u_truth`` (step, node, 2) [mm].
    """
    random, mesh, steps = np.random.default_rng([sheet.seed, 7]), grid_of(sheet), len(equilibria.amount)
    u = equilibria.displacement(mesh.nodes)
    errors = sheet.force_zero + sheet.force_scatter * random.normal(size=(steps, 1))
    measured = THICKNESS * ((1.0 + sheet.force_gain) * equilibria.force + errors * equilibria.force[-1])
    force = np.full((steps, 4, 2), np.nan)
    held = np.zeros((steps, 4, 2))
    stretch = 1.0 + sheet.top * equilibria.amount
    if sheet.load == "biaxial":
        stretch = np.stack([1.0 + sheet.across * sheet.top * equilibria.amount, stretch], axis=1)
        force[:, 1, 0] = measured[:, 0]
    force[:, 3, 1] = measured[:, 1]
    force[:, [0, 2]] = -force[:, [1, 3]]
    load = make_load(sheet.load, stretch)
    for edge, component in load.constrained:
        held[:, EDGE_NAMES.index(edge), component] = 1.0
    level = np.full((steps, 2), noise)
    variables = {
        **{"X": mesh.nodes, "cells": mesh.cells, "corners": np.stack([mesh.lower, mesh.upper])},
        **{"u_measured": (u + random.normal(0.0, noise, u.shape))[None], "u_truth": u},
        **{"noise_level": level, "noise_scatter": level, "relative_thickness": np.ones(len(mesh.cells))},
        **{"load_case": np.zeros(steps, int), "stretch": load.stretch, "H": load.H, "edge_force": force},
        **{"relaxation": np.ones(steps), "edge_constrained": held},
    }
    attributes = {
        **{"noise_uncertainty": 0.05, "force_uncertainty": sheet.force_scatter, "force_gain_uncertainty": 0.005},
        **{"force_offset_uncertainty": 0.001, "correlation_window": 0.0, "thickness": THICKNESS},
        **{"outline": "edge", "mesh": "finer", "forces": "measured", "units": EXPERIMENT_UNITS},
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    write(path, variables, f"virtual sheet {sheet.seed}", attributes)
