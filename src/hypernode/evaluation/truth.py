"""Error of the identified stress against the true material, both at the same deformation."""

import numpy as np
import scipy.sparse
from jaxtyping import Bool, Float, Int

from hypernode.data.measurement import mesh_of
from hypernode.evaluation.judgement import Judgement
from hypernode.evaluation.probes import stress_at_common_F
from hypernode.evaluation.scores import contrast, relative_error
from hypernode.fem.mesh import Mesh
from hypernode.material.field import Material
from hypernode.material.files import lines_of, nearest_cell
from hypernode.material.lines import cut_cells
from hypernode.mechanics.loads import tensile_axis
from hypernode.mechanics.modes import MODES

#: Points along each side of a measured cell at which the truth is averaged.
SAMPLES = 10


def observed_mode(kind: str) -> int:
    """Index in :data:`MODES` of the homogeneous deformation closest to a kind of load."""
    axis = tensile_axis(kind)
    if axis is not None:
        return MODES.index(("strip_x", "strip_y")[axis])
    return MODES.index("shear" if kind == "shear" else "equibiaxial")


def interface_band(mesh: Mesh, inside: Bool[np.ndarray, " cell"]) -> Bool[np.ndarray, " cell"]:
    """Cells that share a node with cells of the other phase."""
    touched = np.zeros((2, len(mesh.nodes)), dtype=bool)
    for side in range(2):
        touched[side, mesh.cells[inside == bool(side)].ravel()] = True
    return touched.all(axis=0)[mesh.cells].any(axis=1)


def cell_means(
    truth, true: Material, mesh: Mesh, F: Float[np.ndarray, "mode stretch 2 2"]
) -> Float[np.ndarray, "mode stretch cell 2 2"] | None:
    """True P at common F averaged over each cell, or None if the grid is that of the truth.

    Args:
        truth, true: file of the true material, and the material itself.
        mesh: the measured grid.
        F: deformation gradients that all points undergo.
    """
    sheet = mesh_of(truth)
    if len(sheet.cells) == len(mesh.cells) and np.allclose(sheet.centres, mesh.centres):
        return None
    cells = np.arange(len(mesh.cells))
    sampled = nearest_cell(truth)(points_of_cells(mesh, cells))
    average = scipy.sparse.csr_matrix(
        (np.full(sampled.size, 1.0 / len(sampled)), (np.tile(cells, len(sampled)), sampled.ravel())),
        (len(cells), len(sheet.cells)),
    )
    P = stress_at_common_F(true, sheet.centres, F)
    means = average @ np.moveaxis(P, -3, 0).reshape(len(sheet.cells), -1)
    return np.moveaxis(means.reshape(len(cells), *P.shape[:2], 2, 2), 0, -3)


def points_of_cells(mesh: Mesh, cells: Int[np.ndarray, " cell"]) -> Float[np.ndarray, "sample cell 2"]:
    """Points at which each of some cells is sampled."""
    places = (np.arange(SAMPLES) + 0.5) / SAMPLES
    low, high = mesh.nodes[mesh.cells[cells, 0]], mesh.nodes[mesh.cells[cells, 2]]
    return low + np.stack(np.meshgrid(places, places), axis=-1).reshape(-1, 1, 2) * (high - low)


def means_where_cut(found: Material, mesh: Mesh, cut: Bool[np.ndarray, " cell"], P, F) -> np.ndarray:
    """Identified P[mode, stretch, cell, i, J] at common F, averaged over the cells that a line cuts.

    Args:
        found: the identified material at any point.
        cut: cells that a line cuts.
        P: stress at the centres of all cells.
        F: deformation gradients that all points undergo.
    """
    P, cells = P.copy(), np.flatnonzero(cut)
    if not len(cells):
        return P
    points = points_of_cells(mesh, cells)
    each = stress_at_common_F(found, points.reshape(-1, 2), F)
    P[:, :, cells] = each.reshape(*each.shape[:2], *points.shape[:2], 2, 2).mean(axis=2)
    return P


def cut_by_lines(constrained) -> Bool[np.ndarray, " cell"]:
    """Cells of a constrained field that a line cuts; none for a field without lines."""
    lines = lines_of(constrained)
    return np.zeros(constrained.sizes["cell"], bool) if lines is None else cut_cells(lines["line_distances"])


def errors_at_common_F(P, P_true, weights: Float[np.ndarray, " cell"]) -> Float[np.ndarray, "mode stretch"]:
    """Relative error of every mode and stretch, P[mode, stretch, cell, i, J]."""
    modes, stretches = P.shape[:2]
    return np.array([[relative_error(P[m, s], P_true[m, s], weights) for s in range(stretches)] for m in range(modes)])


def score_stress(
    mesh: Mesh,
    P: Float[np.ndarray, "mode stretch cell 2 2"],
    P_true: Float[np.ndarray, "mode stretch cell 2 2"],
    phase: Int[np.ndarray, " cell"],
    phases: int,
    observed: int,
) -> Judgement:
    """Errors by mode and phase, and single numbers of the observed mode and of all modes.

    Args:
        P, P_true: identified and true stress at common F.
        phase: true phase of each cell, 0 the matrix.
        phases: number of phases.
        observed: index of the mode closest to the load of the test.
    """
    areas = mesh.areas
    found, true = P[observed], P_true[observed]
    by_phase = [errors_at_common_F(P, P_true, areas * (phase == k)) for k in range(phases)]
    error, correlation = contrast(found, true, areas)
    return Judgement(
        {
            "P_true": P_true,
            "stress_error": errors_at_common_F(P, P_true, areas),
            "stress_error_phase": np.array(by_phase),
            "phase": phase,
        },
        {
            "stress_error": relative_error(found, true, areas),
            "stress_error_all_modes": relative_error(P, P_true, areas),
            "stress_error_other_modes": relative_error(*(np.delete(each, observed, 0) for each in (P, P_true)), areas),
            "stress_error_without_ten_cells": relative_error(found, true, areas * ~worst_cells(found, true, areas, 10)),
            "stress_error_off_interface": relative_error(found, true, areas * ~interface_band(mesh, phase > 0)),
            "contrast_error": error,
            "correlation": correlation,
        },
    )


def worst_cells(P, P_true, areas: Float[np.ndarray, " cell"], count: int) -> Bool[np.ndarray, " cell"]:
    """The cells that contribute most to an error, over all stretches.

    Args:
        P, P_true: stresses (stretch, cell, 2, 2).
        count: how many, at most all cells but one.
    """
    size = areas * ((P - P_true) ** 2).sum(axis=(0, 2, 3))
    worst = np.zeros(len(areas), bool)
    worst[np.argsort(size, kind="stable")[::-1][: min(count, len(areas) - 1)]] = True
    return worst


def score_networks(P, P_constrained, areas: Float[np.ndarray, " cell"]) -> Judgement:
    """Error of the networks against the constrained field that they learnt: total, and in the worst cell.

    Stresses are those of the observed mode (stretch, cell, 2, 2). The error of a cell is over the mean stress of all
    cells.

    Args:
        areas: of the cells that count, zero of others.
    """
    size = np.sqrt(np.einsum("scij,c->", P_constrained**2, areas / areas.sum()))
    missed = np.sqrt(((P - P_constrained) ** 2).sum(axis=(0, 2, 3))) * (areas > 0.0)
    return Judgement(
        summary={
            "network_error": relative_error(P, P_constrained, areas),
            "network_error_worst_cell": float(missed.max() / size),
        }
    )
