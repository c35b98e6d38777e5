"""Stage 0: the sheet of a synthetic test, its mesh and the material of every cell."""

import numpy as np

from hypernode.config import Case, Config
from hypernode.mechanics.material_names import PARAMETERS
from hypernode.mechanics.materials import NEUTRAL
from hypernode.mechanics.mesh import Mesh, rectilinear
from hypernode.stages.geometry import make_shape
from hypernode.storage.netcdf import SYNTHETIC_UNITS, write

PHASES = ("matrix", "inclusion")


def make_mesh(case: Case) -> Mesh:
    """Regular mesh of a synthetic case."""
    nx, ny = case.cells
    return rectilinear(np.linspace(0.0, case.size[0], nx + 1), np.linspace(0.0, case.size[1], ny + 1))


def cell_parameters(weight, matrix, inclusion):
    """Models and parameters of every cell.

    Args:
        weight: share of the inclusion in each cell, 0 to 1 (cell,). Between the two, parameters are
            mixed linearly, which needs both phases to be of one model.
        matrix, inclusion: configured materials; ``inclusion`` may be None.

    Returns:
        (model names, {"model": index per cell, parameter: value per cell}); fibre angles in rad.
    """
    phases = [matrix] if inclusion is None else [matrix, inclusion]
    models = tuple(dict.fromkeys(m.model for m in phases))
    names = list(dict.fromkeys(name for m in phases for name in PARAMETERS[m.model]))
    share = np.stack([1.0 - weight, weight])[: len(phases)]
    mixed = ((weight > 0) & (weight < 1)).any()
    if mixed and len(models) > 1:
        raise ValueError(
            f"a gradient between {models[0]} and {models[1]} has no meaning: use one model for both phases"
        )
    model = np.where(weight > 0.5, models.index(phases[-1].model), models.index(matrix.model))
    values = {"model": model.astype(float)}
    for name in names:
        total = np.zeros(len(weight))
        for part, material in zip(share, phases, strict=True):
            value = material.parameters.get(name, NEUTRAL.get(name, 0.0))
            total += part * (np.deg2rad(value) if name == "fibre_angle" else value)
        values[name] = total
    return models, values


def run(config: Config, name: str, output: str, attributes: dict) -> None:
    """Write the mesh and true material of a synthetic case."""
    case = config.cases[name]
    mesh = make_mesh(case)
    weight = make_shape(config.geometries[case.geometry])((mesh.centres - mesh.lower) / mesh.size)
    inclusion = config.materials[case.inclusion] if case.inclusion else None
    models, values = cell_parameters(weight, config.materials[case.matrix], inclusion)
    variables = {
        "X": mesh.nodes,
        "cells": mesh.cells,
        "corners": np.stack([mesh.lower, mesh.upper]),
        "phase": (weight > 0.5).astype(np.int64),
        **{f"material.{key}": (("cell",), value) for key, value in values.items()},
    }
    write(
        output,
        variables,
        f"true material of {name}",
        {
            **attributes,
            "units": SYNTHETIC_UNITS,
            "material_kind": "closed_form",
            "models": models,
            "phases": PHASES[: 1 if inclusion is None else 2],
        },
    )
