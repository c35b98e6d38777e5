"""Stage 2: what cameras and load cell would record of a synthetic test."""

import numpy as np

from hypernode.config.model import Config
from hypernode.config.synthetic import Noise
from hypernode.data.measurement import mesh_of
from hypernode.data.outliers import outliers
from hypernode.dic.noise.correlation import independent_factor
from hypernode.fem.gradient import deformation_gradient
from hypernode.storage.netcdf import read, units_of, write
from hypernode.synthetic.camera import observed_by
from hypernode.synthetic.errors import with_force_errors, with_noise


def run(config: Config, name: str, forward_file: str, output: str, attributes: dict) -> None:
    """Sample the nodal displacements on the camera's grid and add noise."""
    forward, case = read(forward_file), config.cases[name]
    noise = config.noise[case.noise] if case.noise else Noise()
    mesh, u = mesh_of(forward), forward["u"].values
    if case.camera:
        mesh, u = observed_by(case.camera, mesh, u)
    copied = ("corners", "load_case", "stretch", "H", "edge_force", "edge_constrained")
    variables = {key: forward[key].values for key in copied}
    if not case.camera:
        variables["nodal_force"] = forward["nodal_force"].values
    variables["relaxation"] = np.ones(len(forward["load_case"]))
    variables["relative_thickness"] = np.ones(len(mesh.cells))
    scatter = np.full((len(forward["load_case"]), 2), noise.sigma)
    variables |= {"noise_level": scatter * independent_factor(noise.correlation_length), "noise_scatter": scatter}
    variables |= {"X": mesh.nodes, "cells": mesh.cells, "u_truth": u, "F_truth": deformation_gradient(mesh, u)}
    u_measured = with_noise(mesh, u, noise)
    mistaken = np.stack([outliers(mesh, each, scatter) for each in u_measured])
    u_measured[mistaken] = np.nan
    variables["u_measured"] = u_measured
    variables["edge_force"] = with_force_errors(variables["edge_force"], variables["load_case"], noise)
    carried = {key: forward.attrs[key] for key in ("load_cases", "thickness")}
    write(
        output,
        variables,
        f"synthetic measurement of {name}",
        {
            **attributes,
            **carried,
            "units": units_of(forward),
            "outline": "edge",
            "mesh": "finer" if case.camera else case.mesh,
            "forces": "measured",
            "noise_uncertainty": 0.0,
            "outliers": int(mistaken.sum()),
            "force_uncertainty": noise.force,
            "force_gain_uncertainty": noise.force_gain,
            "force_offset_uncertainty": noise.force_offset,
            "correlation_window": case.camera.window if case.camera else 0.0,
        },
        parents=[forward_file],
    )
