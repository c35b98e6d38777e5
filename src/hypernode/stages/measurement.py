"""Stage 2: what cameras and load cell would record of a synthetic test."""

import numpy as np

from hypernode.config import Config
from hypernode.stages.fields import deformation_gradient, mesh_of
from hypernode.storage.netcdf import read, units_of, write


def run(config: Config, name: str, forward_file: str, output: str, attributes: dict) -> None:
    """Add normally distributed noise to the nodal displacements.

    Every repeat draws from its own stream, seeded by (seed, repeat), so that adding a repeat leaves
    the others as they were.
    """
    forward = read(forward_file)
    noise = config.noise[config.cases[name].noise] if config.cases[name].noise else None
    u = forward["u"].values
    repeats = noise.repeats if noise else 1
    measured = np.repeat(u[None], repeats, axis=0)
    if noise and noise.sigma > 0:
        for repeat in range(repeats):
            rng = np.random.default_rng(np.random.SeedSequence([noise.seed, repeat]))
            measured[repeat] += rng.normal(0.0, noise.sigma, u.shape)
    mesh = mesh_of(forward)
    copied = ("X", "cells", "corners", "test", "stretch", "H", "edge_force", "edge_constrained")
    variables = {key: forward[key].values for key in copied}
    variables |= {"u_measured": measured, "u_truth": u, "F_truth": deformation_gradient(mesh, u)}
    carried = {key: forward.attrs[key] for key in ("tests", "thickness")}
    write(
        output,
        variables,
        f"synthetic measurement of {name}",
        {
            **attributes,
            **carried,
            "units": units_of(forward),
            "displacement_noise": noise.sigma if noise else 0.0,
        },
        parents=[forward_file],
    )
