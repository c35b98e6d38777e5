"""Stage 9: how good an identified material is, on one scale for every run."""

import json

import numpy as np
import scipy.sparse

from hypernode.config.geometries import Image
from hypernode.data.loading import Loading
from hypernode.data.measurement import mesh_of, relaxation
from hypernode.evaluation.probes import SMALLEST_ANISOTROPY, curves, indicator, preferred_direction, stress_at_common_F
from hypernode.evaluation.scores import contrast, relative_error, signal_to_noise
from hypernode.evaluation.shape import (
    boundary_distance,
    dice,
    intersection_over_union,
    registered_dice,
)
from hypernode.fem.equilibrium_gap import relative_gap
from hypernode.fem.gradient import deformation_gradient as element_gradient
from hypernode.fem.mesh import EDGES
from hypernode.fem.nodal_forces import nodal_force_matrices
from hypernode.material.files import material_of, nearest_cell, posterior_material
from hypernode.mechanics.modes import MODES
from hypernode.synthetic.geometry import make_shape

#: Stretch at which the shape is read from the stress.
SHAPE_STRETCH = 1.1
CURVE_POINTS = 21
#: Points along each side of a measured cell at which the truth is averaged.
SAMPLES = 10
#: Signal-to-noise ratio [dB] beyond which there is no noise to speak of.
EXACT = 200.0


def _equilibrium(mesh, loading: Loading, P):
    """Judge the stress field P[step, cell, i, J]: forces, nodal residual, gap."""
    D = nodal_force_matrices(mesh)
    nodal = np.stack([sum(D[J] @ P[:, :, i, J].T for J in range(2)).T for i in range(2)], axis=-1)
    forces = np.full((len(P), len(EDGES), 2), np.nan)
    held = np.zeros((len(P), *nodal.shape[1:]), dtype=bool)
    for index, edge in enumerate(EDGES):
        on = mesh.on_edge(edge)
        for i in range(2):
            constrained = loading.constrained[loading.load_case, index, i]
            forces[constrained, index, i] = nodal[constrained][:, on, i].sum(axis=1)
            held[np.ix_(constrained, on, [i])] = True
    free = np.where(held, 0.0, nodal)
    gradient = mesh.gradient_operator() * mesh.areas[:, None, None]
    cell_forces = np.einsum("caJ,sciJ->scai", gradient, P)
    residual = np.sqrt((free**2).sum(axis=(1, 2)) / (cell_forces**2).sum(axis=(1, 2, 3)))
    gap = np.zeros(len(P))
    for k in range(loading.load_case.max() + 1):
        steps = np.flatnonzero(loading.load_case == k)
        gap[steps] = relative_gap(
            mesh, loading.constrained[k], loading.known[k], P[steps], loading.resultant[steps], loading.scale[steps]
        )
    return forces, residual, gap


def trained_weights(file) -> int:
    """Number of trained weights of an identified material."""
    return int(sum(file[v].size for v in file if v.startswith("hypernetwork.") and "frequencies" not in v))


def _judge_equilibrium(mesh, loading, measurement, P_field, variables, summary):
    """Edge forces, nodal residual and equilibrium gap of the stress at the measured deformation."""
    forces, residual, gap = _equilibrium(mesh, loading, P_field)
    forces = forces * float(measurement.attrs["thickness"]) * relaxation(measurement)
    measured = measurement["edge_force"].values
    with np.errstate(invalid="ignore"):
        relative = np.abs(forces - measured) / np.nanmax(np.abs(measured), axis=(1, 2), keepdims=True)
    error = np.nanmax(np.where(np.isfinite(measured), relative, np.nan), axis=(1, 2))
    variables |= {
        "edge_force": measured,
        "edge_force_identified": forces,
        "edge_force_error": error,
        "equilibrium_residual": residual,
        "equilibrium_gap": gap,
    }
    summary |= {
        "edge_force_error": float(error.max()),
        "equilibrium_residual": float(residual.max()),
        "equilibrium_gap": float(gap.max()),
    }


def _judge_shape(mesh, field, shape, true_shape, variables, summary):
    """How much stiffer the found inclusion is, and how well it covers the true or printed one where that is known."""
    if shape.any() and not shape.all():
        summary["inclusion_over_matrix"] = float(field[shape].mean() / field[~shape].mean())
    if true_shape is not None:
        variables["shape_true"] = true_shape.astype(np.int64)
        summary |= {
            "dice": dice(shape, true_shape),
            "iou": intersection_over_union(shape, true_shape),
            "boundary_distance": boundary_distance(mesh, shape, true_shape),
        }


def _judge_curves(found, true, places, stretch, kind, variables, summary):
    """Stress-stretch curves at one place of each phase, and their scores where the truth is known."""
    variables |= {
        "curve_location": places,
        "curve_stretch": stretch,
        "curve_identified": curves(found, places, stretch, kind),
    }
    if true is not None:
        variables["curve_true"] = curves(true, places, stretch, kind)
        summary |= _curve_scores(variables["curve_identified"], variables["curve_true"])


def _judge_noise(mesh, measurement, fields, variables, summary):
    """Signal-to-noise ratio of the differentiated measurement and of what the method made of it."""
    true = measurement["F_truth"].values
    fields = {"measured": element_gradient(mesh, measurement["u_measured"].values.mean(axis=0)), **fields}
    for label, F in fields.items():
        variables[f"snr_{label}"] = signal_to_noise(F, true)
        if variables[f"snr_{label}"].max() < EXACT:
            summary[f"snr_{label}"] = float(variables[f"snr_{label}"].mean())


def _cell_means(truth, true, mesh, F):
    """True P at common F averaged over each cell of a grid that is not the truth's own, or None."""
    sheet = mesh_of(truth)
    if len(sheet.cells) == len(mesh.cells) and np.allclose(sheet.centres, mesh.centres):
        return None
    places = (np.arange(SAMPLES) + 0.5) / SAMPLES
    low, high = mesh.nodes[mesh.cells[:, 0]], mesh.nodes[mesh.cells[:, 2]]
    share = np.stack(np.meshgrid(places, places), axis=-1).reshape(-1, 1, 2)
    sampled = nearest_cell(truth)(low + share * (high - low))
    average = scipy.sparse.csr_matrix(
        (np.full(sampled.size, 1.0 / len(share)), (np.tile(np.arange(len(low)), len(share)), sampled.ravel())),
        (len(low), len(sheet.cells)),
    )
    P = stress_at_common_F(true, sheet.centres, F)
    means = average @ np.moveaxis(P, -3, 0).reshape(len(sheet.cells), -1)
    return np.moveaxis(means.reshape(len(low), *P.shape[:2], 2, 2), 0, -3)


def _seen_mode(kind: str) -> int:
    """Index of the judged mode that is closest to a kind of load."""
    if kind in ("equibiaxial", "biaxial"):
        return MODES.index("equibiaxial")
    return MODES.index("strip_x" if kind.endswith("x") else "strip_y")


def _judge_spread(constrained, mesh, kind, stretch, true, variables, summary):
    """How uncertain the constrained field is, cell by cell, and whether the truth lies as far from it as that says."""
    drawn = posterior_material(constrained)
    if drawn is None:
        return
    draws = indicator(drawn, np.tile(mesh.centres, (constrained.sizes["posterior_sample"], 1)), kind, stretch)
    spread = draws.reshape(-1, len(mesh.centres)).std(axis=0, ddof=1)
    best = indicator(material_of(constrained), mesh.centres, kind, stretch)
    variables["trace_P_spread"] = spread
    summary["spread"] = float(np.sqrt(np.mean(spread**2) / np.mean(best**2)))
    if true is not None:
        missed = np.abs(best - indicator(true, mesh.centres, kind, stretch))
        summary["within_two_spreads"] = float(np.mean(missed <= 2.0 * spread))


def _judge_constrained(constrained, mesh, F, kind, variables, summary):
    """Where the error comes from: the constrained field against the truth, and the networks against that field."""
    seen = _seen_mode(kind)
    P = stress_at_common_F(material_of(constrained), mesh.centres, F[seen : seen + 1])[0]
    summary["stress_error_constrained"] = relative_error(P, variables["P_true"][seen], mesh.areas)
    summary["network_error"] = relative_error(variables["P_identified"][seen], P, mesh.areas)


def _judge_truth(truth, true, found, mesh, F, kind, variables, summary):
    """Compare with the true material; fills ``variables`` and ``summary``, returns the true shape."""
    X, areas = mesh.centres, mesh.areas
    P_true, P = stress_at_common_F(true, X, F), variables["P_identified"]
    largest = float(F[0, -1, 0, 0])
    phase = truth["phase"].values[nearest_cell(truth)(X)]
    phases = json.loads(truth.attrs["phases"])
    by_mode = [[relative_error(P[m, s], P_true[m, s], areas) for s in range(F.shape[1])] for m in range(len(MODES))]
    by_phase = [
        [
            [relative_error(P[m, s], P_true[m, s], areas * (phase == k)) for s in range(F.shape[1])]
            for m in range(len(MODES))
        ]
        for k in range(len(phases))
    ]
    true_shape = phase > 0
    corner = mesh.cells
    nodal = np.zeros((2, len(mesh.nodes)), dtype=bool)
    for side in range(2):
        nodal[side, corner[true_shape == bool(side)].ravel()] = True
    band = nodal.all(axis=0)[corner].any(axis=1)
    seen = _seen_mode(kind)
    error, correlation = contrast(P[seen], P_true[seen], areas)
    variables |= {
        "P_true": P_true,
        "stress_error": np.array(by_mode),
        "stress_error_phase": np.array(by_phase),
        "phase": phase,
    }
    anisotropy, angle = preferred_direction(found, X, largest)
    true_anisotropy, true_angle = preferred_direction(true, X, largest)
    fibres = true_anisotropy > SMALLEST_ANISOTROPY
    variables |= {"anisotropy": anisotropy, "fibre_angle": angle}
    variables |= {"anisotropy_true": true_anisotropy, "fibre_angle_true": true_angle}
    if fibres.any():
        off = np.abs((angle - true_angle + 90.0) % 180.0 - 90.0)[fibres]
        summary |= {
            "fibre_angle_error": float(np.median(off)),
            "anisotropy_error": float(np.median(np.abs(anisotropy - true_anisotropy)[fibres])),
        }
    summary |= {
        "stress_error": relative_error(P[seen], P_true[seen], areas),
        "stress_error_all_modes": relative_error(P, P_true, areas),
        "stress_error_off_interface": relative_error(P[seen], P_true[seen], areas * ~band),
        "contrast_error": error,
        "correlation": correlation,
    }
    means = _cell_means(truth, true, mesh, F[seen : seen + 1])
    if means is not None:
        summary["stress_error_cell_mean"] = relative_error(P[seen], means[0], areas)
    return true_shape


def _judge_printed(printed, flipped, measurement, mesh, shape, summary):
    """Compare the found shape with the printed one; returns the printed shape on the cells."""
    reference = make_shape(Image(shape="image", path=printed))
    lower, upper = np.array(json.loads(measurement.attrs["field_corners"]))
    X = (mesh.centres - lower) / (upper - lower)
    if flipped:
        X = X * (1.0, -1.0) + (0.0, 1.0)
    summary["dice_registered"], summary["registration"] = registered_dice(shape, reference, X)
    return reference(X) > 0.5


def _curve_scores(found, true):
    """NRMSE (over the range of the truth) and R2 of the stress-stretch curves of each location."""
    scores = {}
    for index, phase in enumerate(("matrix", "inclusion")):
        error = np.sqrt(np.mean((found[index] - true[index]) ** 2))
        spread = np.sum((true[index] - true[index].mean()) ** 2)
        scores[f"curve_nrmse_{phase}"] = float(error / np.ptp(true[index]))
        scores[f"curve_r2_{phase}"] = float(1.0 - np.sum((found[index] - true[index]) ** 2) / spread)
    return scores
