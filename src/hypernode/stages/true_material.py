"""Stage 0: the sheet of a synthetic test, its mesh and the material of every cell."""

import numpy as np

from hypernode.config.model import Config
from hypernode.storage.netcdf import sha256, sheet_units, write
from hypernode.synthetic.geometry import make_shape
from hypernode.synthetic.sheet import PHASES, cell_parameters, make_mesh, phase_shares


def run(config: Config, name: str, output: str, attributes: dict) -> None:
    """Write the mesh and true material of a synthetic case."""
    case = config.cases[name]
    images = [g.path for g in config.geometries.values() if g.shape == "image"]
    shapes = {key: make_shape(geometry) for key, geometry in config.geometries.items()}
    mesh = make_mesh(case, shapes[case.hole] if case.hole else None)
    X = (mesh.centres - mesh.lower) / mesh.size
    shares, names = phase_shares(case, shapes, X)
    models, values = cell_parameters(shares, [config.materials[key] for key in names])
    variables = {
        "X": mesh.nodes,
        "cells": mesh.cells,
        "corners": np.stack([mesh.lower, mesh.upper]),
        "phase": np.argmax(shares, axis=0).astype(np.int64),
        **{f"material.{key}": (("cell",), value) for key, value in values.items()},
    }
    write(
        output,
        variables,
        f"true material of {name}",
        {
            **attributes,
            "units": sheet_units(case.thickness),
            "raw_inputs": {path: sha256(path) for path in images},
            "material_kind": "closed_form",
            "models": models,
            "phases": [*PHASES, *(f"layer {k}" for k in range(1, len(names) - 1))][: len(names)],
        },
    )
