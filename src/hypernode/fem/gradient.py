"""Deformation gradients on a mesh from nodal displacements."""

import numpy as np
from jaxtyping import Float

from hypernode.fem.mesh import Mesh


def deformation_gradient(mesh: Mesh, u: Float[np.ndarray, "... node 2"]) -> Float[np.ndarray, "... cell 2 2"]:
    """F at the cell centres from nodal displacements, by bilinear shape functions."""
    return np.einsum("...cai,caJ->...ciJ", u[..., mesh.cells, :], mesh.gradient_operator()) + np.eye(2)


def mean_gradient(mesh: Mesh, F: Float[np.ndarray, "2 2 step cell"]) -> Float[np.ndarray, "2 2 step 1"]:
    """Mean of F over the sheet."""
    return np.sum(F * (mesh.areas / mesh.areas.sum()), axis=-1, keepdims=True)


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


METHODS = {"element": deformation_gradient, "finite_difference": central_differences}
