"""Whether the stress of the identified material is in equilibrium and carries the measured forces.

The answer depends on the deformation at which the stress is taken. At the measured deformation, the plain gradient of
the measured displacements, noise adds to the error of the material. At the identified deformation only errors of the
method count.
"""

import numpy as np
from jaxtyping import Bool, Float

from hypernode.data.loading import Loading
from hypernode.data.measurement import is_cut_out, mean_of_ends, relative_thickness, relaxation
from hypernode.data.seen_share import carried_shares, seen_shares
from hypernode.evaluation.judgement import Judgement
from hypernode.fem.equilibrium_gap import relative_gap
from hypernode.fem.mesh import EDGES, Mesh
from hypernode.fem.nodal_forces import nodal_force_matrices
from hypernode.material.field import Material
from hypernode.mechanics.kinematics import largest_principal_strain


def stress_at(material: Material, X, F: Float[np.ndarray, "step cell 2 2"]) -> Float[np.ndarray, "step cell 2 2"]:
    """P of every cell at its own F; NaN if noise inverts the cell (det F <= 0) or the stress overflows."""
    P = np.asarray(material.stress(X, F), float)
    valid = (np.linalg.det(F) > 0.0) & np.isfinite(P).all(axis=(-2, -1))
    return np.where(valid[..., None, None], P, np.nan)


def nodal_forces(mesh: Mesh, P: Float[np.ndarray, "step cell 2 2"]) -> Float[np.ndarray, "step node 2"]:
    """Nodal forces of a stress that is constant in each cell, per unit thickness."""
    D = nodal_force_matrices(mesh)
    return np.stack([sum(D[J] @ P[:, :, i, J].T for J in range(2)).T for i in range(2)], axis=-1)


def prescribed_nodes(mesh: Mesh, loading: Loading) -> Bool[np.ndarray, "step node 2"]:
    """Which displacement components of which nodes are prescribed."""
    prescribed = np.zeros((len(loading.load_case), len(mesh.nodes), 2), dtype=bool)
    for index, edge in enumerate(EDGES):
        for i in range(2):
            steps = loading.constrained[loading.load_case, index, i]
            prescribed[np.ix_(steps, mesh.on_edge(edge), [i])] = True
    return prescribed


def edge_resultants(
    mesh: Mesh, loading: Loading, nodal: Float[np.ndarray, "step node 2"], carried: Float[np.ndarray, "step axis"]
) -> Float[np.ndarray, "step edge 2"]:
    """Outward force on each edge, per unit thickness; NaN where the displacement is not prescribed.

    Args:
        carried: of :func:`~hypernode.data.seen_share.carried_shares`; by it what edges of a part of a sheet carry
            becomes the share of the width of what the sheet does.
    """
    forces = np.full((len(nodal), len(EDGES), 2), np.nan)
    for index, (edge, (axis, _)) in enumerate(EDGES.items()):
        for i in range(2):
            steps = loading.constrained[loading.load_case, index, i]
            forces[steps, index, i] = (nodal[:, mesh.on_edge(edge), i].sum(axis=1) / carried[:, axis])[steps]
    return forces


def nodal_residual(
    mesh: Mesh, loading: Loading, nodal: Float[np.ndarray, "step node 2"], P: Float[np.ndarray, "step cell 2 2"]
) -> Float[np.ndarray, " step"]:
    """Norm of the unbalanced nodal forces over the norm of the forces that the cells exert on their nodes."""
    free = np.where(prescribed_nodes(mesh, loading), 0.0, nodal)
    gradient = mesh.gradient_operator() * mesh.areas[:, None, None]
    cell_forces = np.einsum("caJ,sciJ->scai", gradient, P)
    return np.sqrt((free**2).sum(axis=(1, 2)) / (cell_forces**2).sum(axis=(1, 2, 3)))


def equilibrium_gap(mesh: Mesh, loading: Loading, P: Float[np.ndarray, "step cell 2 2"]) -> Float[np.ndarray, " step"]:
    """Relative L2 distance of P from the nearest stress in equilibrium with the measured resultants."""
    gap = np.zeros(len(P))
    for k in range(loading.load_case.max() + 1):
        steps = np.flatnonzero(loading.load_case == k)
        gap[steps] = relative_gap(
            mesh, loading.constrained[k], loading.known[k], P[steps], loading.resultant[steps], loading.scale[steps]
        )
    return gap


def edge_force_error(
    found: Float[np.ndarray, "step edge 2"],
    measured: Float[np.ndarray, "step edge 2"],
    prescribed: Bool[np.ndarray, "step edge 2"],
    cut: bool = False,
) -> Float[np.ndarray, " step"]:
    """Largest error of the measured resultants on prescribed edges, over the largest resultant of the step.

    Args:
        cut: whether the grid is cut out of a larger sheet. Its ends then carry different parts of one force, and their
            mean counts.
    """
    known = np.isfinite(measured) & prescribed
    largest = np.nan_to_num(np.abs(measured)).max(axis=(1, 2))
    missed = np.where(known, found - measured, np.nan)
    ends = [mean_of_ends(missed, axis, i) for axis, i in np.ndindex(2, 2)]
    each = ends if cut else missed.reshape(len(missed), -1).T
    worst = np.max(np.nan_to_num(np.abs(each)), axis=0)
    return np.divide(worst, largest, out=np.zeros(len(worst)), where=largest > 0.0)


def score_equilibrium(
    mesh: Mesh, loading: Loading, measurement, F: Float[np.ndarray, "step cell 2 2"], P, deformation: str
) -> Judgement:
    """Principal strain, edge forces, nodal residual and equilibrium gap at one deformation.

    Args:
        F, P: deformation gradient and stress of every step and cell.
        deformation: ``measured`` or ``identified``, the ending of the names.
    """
    # What is in equilibrium is the force per length, the stress times the thickness.
    P = P * relative_thickness(measurement)[:, None, None]
    nodal = nodal_forces(mesh, P)
    carried = carried_shares(mesh, loading, P, seen_shares(measurement))
    forces = edge_resultants(mesh, loading, nodal, carried)
    forces *= float(measurement.attrs["thickness"]) * relaxation(measurement)
    constrained = loading.constrained[loading.load_case]
    strain = np.asarray(largest_principal_strain(np.moveaxis(F, (2, 3), (0, 1))))
    by_step = {
        "edge_force_error": edge_force_error(
            forces, measurement["edge_force"].values, constrained, is_cut_out(measurement)
        ),
        "equilibrium_residual": nodal_residual(mesh, loading, nodal, P),
        "equilibrium_gap": equilibrium_gap(mesh, loading, P),
    }
    by_step = {f"{key}_{deformation}": values for key, values in by_step.items()}
    fields = {f"edge_force_at_{deformation}": forces, f"principal_strain_{deformation}": strain}
    return Judgement(fields | by_step, {key: float(values.max()) for key, values in by_step.items()})
