"""Stage 5: one set of neural-ODE parameters for the whole sheet."""

import dataclasses
import json
from collections.abc import Mapping

import numpy as np

from hypernode.config.methods import Method
from hypernode.data.loading import Loading
from hypernode.data.measurement import field_gradient, mesh_of
from hypernode.material.basis_file import basis_field
from hypernode.storage.netcdf import read, units_of, write
from hypernode.storage.schema import without_truth
from hypernode.training.homogenised import fit_homogenised


def run(method: Method, name: str, files: Mapping[str, str], output: str, attributes: dict) -> None:
    """Fit the homogenised material of one case and write it.

    Args:
        files: paths of ``measurement``, ``field`` (interpolant or gradient), and ``constrained`` where there is one.
    """
    opened = {key: without_truth(read(path)) for key, path in files.items()}
    measurement, loading = opened["measurement"], Loading.of(opened["measurement"])
    terms = basis_field(opened["constrained"])[0].terms if "constrained" in opened else ()
    F, mesh = field_gradient(opened["field"]), mesh_of(measurement)
    found = fit_homogenised(method, name, mesh, loading, F, terms)
    write(
        output,
        {
            "X": mesh.nodes,
            "cells": mesh.cells,
            "corners": np.stack([mesh.lower, mesh.upper]),
            "node_params": found.fit.params,
            "P_average": loading.P_average,
            "P_homogenised": found.P,
            "loss": found.fit.losses,
            "loss_iteration": found.fit.iterations,
        },
        f"homogenised material of {name}",
        {
            **attributes,
            "units": units_of(measurement),
            "material_kind": "homogenised",
            "node": json.dumps(dataclasses.asdict(found.node)),
        },
        parents=list(files.values()),
    )
