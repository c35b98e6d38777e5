"""Stage 4: a continuous deformation gradient (X, t) -> F for every load case."""

import numpy as np

from hypernode.config.methods import Interpolant
from hypernode.data.measurement import mesh_of
from hypernode.networks.weights import to_arrays
from hypernode.storage.netcdf import read, units_of, write
from hypernode.storage.schema import without_truth
from hypernode.training.interpolant import fit_interpolant, relative_variance


def run(
    settings: Interpolant,
    seed: int,
    name: str,
    gradient_file: str,
    output: str,
    attributes: dict,
    normalised: bool = True,
) -> None:
    """Fit the interpolant of one case and write its networks and what they make of F."""
    data = without_truth(read(gradient_file))
    mesh, F = mesh_of(data), data["F"].values
    found = fit_interpolant(settings, seed, name, mesh, data["load_case"].values, F, normalised)
    variables = {key: data[key].values for key in ("X", "cells", "corners", "load_case", "stretch")}
    for case, network in enumerate(found.networks):
        variables |= to_arrays(network, f"interpolant{case}")
    axes = (1, 2, 3)
    missed, size = (np.sum(each**2, axis=axes) for each in (found.F - F, F - np.eye(2)))
    variables |= {
        "t": found.t,
        "amplitude": found.amplitude,
        "loss": found.losses,
        "loss_iteration": found.iterations,
        "F_interpolated": found.F,
        "gradient_variance": relative_variance(mesh, found.F - F),
        "misfit": np.sqrt(missed / size),
    }
    write(
        output,
        variables,
        f"interpolated deformation gradient of {name}",
        {
            **attributes,
            "units": units_of(data),
            "interpolant": settings.model_dump_json(),
            "length_scale": float(mesh.size.max()),
        },
        parents=[gradient_file],
    )
