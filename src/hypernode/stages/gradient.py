"""Stage 3: deformation gradients at the cell centres from measured displacements."""

import numpy as np

from hypernode.data.lost import filled
from hypernode.data.measurement import measured_displacement, mesh_of
from hypernode.evaluation.noise import signal_to_noise
from hypernode.fem.gradient import METHODS
from hypernode.storage.netcdf import read, units_of, write


def run(
    kind: str, name: str, measurement_file: str, output: str, attributes: dict, constrained_file: str | None = None
) -> None:
    """Differentiate the mean of the repeats, or the equilibrium field that explains them.

    Where points were lost, the former is what is smoothest between their neighbours.

    Args:
        kind: ``element`` (bilinear shape functions) or ``finite_difference`` (central differences).
        constrained_file: file of the equilibrium field, if the method has one.
    """
    measurement = read(measurement_file)
    mesh = mesh_of(measurement)
    u = read(constrained_file)["u"].values if constrained_file else filled(mesh, measured_displacement(measurement))
    F = METHODS[kind](mesh, u)
    J = F[..., 0, 0] * F[..., 1, 1] - F[..., 0, 1] * F[..., 1, 0]
    if (J <= 0).any():
        step, cell = np.unravel_index(int(np.argmin(J)), J.shape)
        raise ValueError(
            f"{measurement_file}: load step {step} folds the sheet over at {mesh.centres[cell].round(4)} "
            f"(det F = {J.min():.3g}): mask that point or leave the frame out"
        )
    variables = {key: measurement[key].values for key in ("X", "cells", "corners", "load_case", "stretch")}
    variables["F"] = F
    # No cell of it is in more doubt than another; an interpolant knows where it misses F.
    variables["gradient_variance"] = np.ones(len(mesh.cells))
    if "F_truth" in measurement:
        variables["F_truth"] = measurement["F_truth"].values
        variables["snr"] = signal_to_noise(F, variables["F_truth"])
    write(
        output,
        variables,
        f"deformation gradients of {name}",
        {**attributes, "units": units_of(measurement), "gradient": kind},
        parents=[p for p in (measurement_file, constrained_file) if p],
    )
