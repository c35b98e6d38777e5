"""Stage 2: what cameras and load cell would record of a synthetic test."""

import numpy as np

from hypernode.config.model import Config
from hypernode.data.measurement import mesh_of
from hypernode.fem.gradient import deformation_gradient
from hypernode.storage.netcdf import read, units_of, write
from hypernode.synthetic.camera import observed_by, with_noise


def run(config: Config, name: str, forward_file: str, output: str, attributes: dict) -> None:
    """Sample the nodal displacements on the camera's grid and add noise."""
    forward, case = read(forward_file), config.cases[name]
    noise = config.noise[case.noise] if case.noise else None
    mesh, u = mesh_of(forward), forward["u"].values
    if case.camera:
        mesh, u = observed_by(case.camera, mesh, u)
    copied = ("corners", "load_case", "stretch", "H", "edge_force", "edge_constrained")
    variables = {key: forward[key].values for key in copied}
    variables["relaxation"] = np.ones(len(forward["load_case"]))
    variables["relative_thickness"] = np.ones(len(mesh.cells))
    level = np.full((len(forward["load_case"]), 2), noise.sigma if noise else 0.0)
    variables |= {"noise_level": level, "noise_scatter": level}
    variables |= {"X": mesh.nodes, "cells": mesh.cells}
    variables |= {"u_measured": with_noise(u, noise), "u_truth": u, "F_truth": deformation_gradient(mesh, u)}
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
            "forces": "measured",
            "force_uncertainty": 0.0,
            "correlation_window": case.camera.window if case.camera else 0.0,
        },
        parents=[forward_file],
    )
