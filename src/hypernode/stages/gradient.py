"""Stage 3: deformation gradients at the cell centres from measured displacements."""

import numpy as np

from hypernode.mechanics.mesh import Mesh
from hypernode.stages.fields import deformation_gradient, mesh_of
from hypernode.storage.netcdf import read, units_of, write


def central_differences(mesh: Mesh, u):
    """F at the cell centres from central differences at the nodes (the paper's FDM).

    The difference at a node is the mean of the one-sided differences along the grid lines of the
    cells around it: central inside, one-sided on edges and beside lost points. Cells take the mean
    of their four nodes.
    """
    corner = mesh.nodes[mesh.cells]
    width, height = np.ptp(corner[..., 0], axis=1), np.ptp(corner[..., 1], axis=1)
    nodal = u[..., mesh.cells, :]
    # One-sided differences at each corner of a cell: along its bottom or top, its left or right side.
    dx = np.stack([nodal[..., b, :] - nodal[..., a, :] for a, b in ((0, 1), (0, 1), (3, 2), (3, 2))], axis=-2)
    dy = np.stack([nodal[..., b, :] - nodal[..., a, :] for a, b in ((0, 3), (1, 2), (1, 2), (0, 3))], axis=-2)
    gradient = np.stack([dx / width[:, None, None], dy / height[:, None, None]], axis=-1)
    flat = gradient.reshape(-1, len(mesh.cells), 4, 2, 2)
    total = np.zeros((len(flat), len(mesh.nodes), 2, 2))
    count = np.bincount(mesh.cells.ravel(), minlength=len(mesh.nodes))
    for field, target in zip(flat, total, strict=True):
        np.add.at(target, mesh.cells, field)
    mean = (total / count[:, None, None])[:, mesh.cells].mean(axis=2) + np.eye(2)
    return mean.reshape(*u.shape[:-2], len(mesh.cells), 2, 2)


def signal_to_noise(F, F_truth):
    """SNR of each step in decibels, equation ``eq:SNR``: sum |F|^2 over sum of the squared error."""
    axes = (1, 2, 3)
    error = np.sum((F - F_truth) ** 2, axis=axes)
    return 10.0 * np.log10(np.sum(F_truth**2, axis=axes) / np.maximum(error, 1e-300))


METHODS = {"element": deformation_gradient, "finite_difference": central_differences}


def run(
    kind: str, name: str, measurement_file: str, output: str, attributes: dict, constrained_file: str | None = None
) -> None:
    """Differentiate the mean of the repeats, or the equilibrium field that explains them.

    Args:
        kind: ``element`` (bilinear shape functions) or ``finite_difference`` (central differences).
        constrained_file: file of the equilibrium field, if the method has one.
    """
    measurement = read(measurement_file)
    mesh = mesh_of(measurement)
    u = read(constrained_file)["u"].values if constrained_file else measurement["u_measured"].values.mean(axis=0)
    F = METHODS[kind](mesh, u)
    J = F[..., 0, 0] * F[..., 1, 1] - F[..., 0, 1] * F[..., 1, 0]
    if (J <= 0).any():
        step, cell = np.unravel_index(int(np.argmin(J)), J.shape)
        raise ValueError(
            f"{measurement_file}: load step {step} folds the sheet over at {mesh.centres[cell].round(4)} "
            f"(det F = {J.min():.3g}): mask that point or leave the frame out"
        )
    variables = {key: measurement[key].values for key in ("X", "cells", "corners", "test", "stretch")}
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
