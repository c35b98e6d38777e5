"""All parts of the evaluation of one run."""

import json
from collections.abc import Mapping

import numpy as np
import xarray as xr

from hypernode.data.loading import Loading
from hypernode.data.lost import filled
from hypernode.data.measurement import (
    is_on_its_own_grid,
    measured_displacement,
    mesh_of,
    noise_of_steps,
)
from hypernode.evaluation.compression import score_compression
from hypernode.evaluation.curves import score_curves
from hypernode.evaluation.ending import score_ending
from hypernode.evaluation.equilibrium import score_equilibrium, stress_at
from hypernode.evaluation.fibres import score_fibres
from hypernode.evaluation.judgement import Judgement
from hypernode.evaluation.level_budget import level_beside_samples, level_budget
from hypernode.evaluation.noise import score_noise
from hypernode.evaluation.phases import score_phases
from hypernode.evaluation.polish import identified_gradient, score_polish
from hypernode.evaluation.probes import indicator, stress_at_common_F
from hypernode.evaluation.ratios import Ratio, beside_unbounded, ratios
from hypernode.evaluation.region import score_region
from hypernode.evaluation.scores import relative_error
from hypernode.evaluation.shape import PrintedShape, curve_places, score_printed, score_shape
from hypernode.evaluation.spread import Samples, score_spread, spread_of_cut_cells
from hypernode.evaluation.truth import (
    cell_means,
    cut_by_lines,
    means_where_cut,
    observed_mode,
    score_networks,
    score_stress,
)
from hypernode.fem.gradient import deformation_gradient
from hypernode.material.files import material_of, nearest_cell
from hypernode.mechanics.modes import mode_gradients

#: Stretch at which the shape is read from the stress.
SHAPE_STRETCH = 1.1


def shape_stretch(measurement: xr.Dataset) -> float:
    """Stretch at which the shape is determined: :data:`SHAPE_STRETCH`, or the largest of the test if that is
    smaller."""
    return min(SHAPE_STRETCH, float(measurement["stretch"].values.max()))


def judge(files: Mapping[str, xr.Dataset], kind: str, stretches, printed: PrintedShape | None = None) -> Judgement:
    """Evaluate the identified material of one run.

    Args:
        files: opened ``measurement``, ``gradient``, ``field`` (interpolant or gradient) and ``material``;
            ``constrained`` where the method has one, and ``truth`` where it is known.
        kind: kind of the first load.
        stretches: stretches at which materials are compared (stretch,).
        printed: the shape of a specimen, if known.

    Raises:
        ValueError: the constrained field does not say how it ended, or no shape can be read from the material.
    """
    measurement, constrained, truth = (files.get(key) for key in ("measurement", "constrained", "truth"))
    mesh, found = mesh_of(measurement), material_of(files["material"])
    true = None if truth is None else material_of(truth)
    stretch, largest = shape_stretch(measurement), float(measurement["stretch"].values.max())
    field = indicator(found, mesh.centres, kind, stretch)
    samples = None if constrained is None else Samples.of(constrained, mesh.centres, kind, stretch)
    deviations = None if samples is None else samples.deviations
    phases = score_phases(mesh, field, deviations, noisy=bool(noise_of_steps(measurement).any()))
    shape = phases.variables["shape"] > 0
    judged = Judgement(
        {
            "X": mesh.nodes,
            "cells": mesh.cells,
            "corners": np.stack([mesh.lower, mesh.upper]),
            "stretch": measurement["stretch"].values,
            "edge_force": measurement["edge_force"].values,
            "trace_P": field,
        }
    )
    judged |= phases | _at_both_deformations(files, found)
    modes, true_shape = _at_common_F(files, found, true, kind, mode_gradients(stretches))
    judged |= modes
    if true is not None:
        judged |= score_fibres(found, true, mesh.centres, float(modes.variables["mode_F"][0, -1, 0, 0]))
    elif printed is not None:
        registered, true_shape = score_printed(mesh, shape, printed)
        judged |= registered
    if "misfit" in files["field"]:
        misfit = files["field"]["misfit"].values
        judged |= Judgement({"misfit": misfit}, {"interpolant_misfit": float(misfit.max())})
    if constrained is not None:
        judged |= score_ending(constrained)
    judged |= score_polish(files["material"])
    budget = level_budget(measurement, judged.variables["P_field"])
    if budget is not None:
        judged |= Judgement(summary={"level_uncertainty": budget.level}, budget=budget)
    if samples is not None:
        found_phase = phases.variables["phase_found"]
        cut = 0.0 if is_on_its_own_grid(measurement) else spread_of_cut_cells(mesh, found_phase, field, constrained)
        beside = level_beside_samples(budget) * np.abs(field)
        true_field = None if true is None else indicator(true, mesh.centres, kind, stretch)
        contrasts = _contrasts(constrained, found_phase, samples)
        judged |= Judgement(summary={"stiffness_ratios": [each.stored() for each in contrasts]})
        judged |= score_spread(samples, true_field, cut, beside, ~beside_unbounded(mesh, found_phase, contrasts))
    judged |= score_shape(mesh, field, shape, true_shape)
    places = curve_places(mesh, shape, None if true is None else true_shape)
    return judged | score_curves(found, true, places, largest, kind)


def _contrasts(constrained: xr.Dataset, phase, samples: Samples) -> list[Ratio]:
    """How many times as stiff each phase of a field of few materials is."""
    few = int(constrained.attrs.get("materials", 0)) > 1
    return ratios(phase, samples.best, samples.values) if few else []


def _at_both_deformations(files, found) -> Judgement:
    """Equilibrium and noise at the measured and at the identified deformation."""
    measurement = files["measurement"]
    mesh, loading = mesh_of(measurement), Loading.of(measurement)
    deformations = {
        "measured": deformation_gradient(mesh, filled(mesh, measured_displacement(measurement))),
        "identified": np.moveaxis(identified_gradient(files["field"], files["material"]), (0, 1), (2, 3)),
    }
    stresses = {key: stress_at(found, mesh.centres, F) for key, F in deformations.items()}
    if "P_jump" in files.get("constrained", {}):
        # A cell that a line cuts is of two layers; the material knows the one at its centre.
        stresses["identified"] = stresses["identified"] + files["constrained"]["P_jump"].values
    judged = Judgement({"P_field": stresses["identified"]}) | score_region(deformations["identified"])
    judged |= score_compression(deformations["identified"], stresses["identified"])
    for key, F in deformations.items():
        judged |= score_equilibrium(mesh, loading, measurement, F, stresses[key], key)
    if "F_truth" in measurement:
        fields = {
            "measured": deformations["measured"],
            "smoothed": files["gradient"]["F"].values,
            "used": deformations["identified"],
        }
        judged |= score_noise(fields, measurement["F_truth"].values)
    return judged


def _at_common_F(files, found, true, kind, F):
    """(stresses of prescribed homogeneous deformations against the true ones, the true shape or None)."""
    mesh, observed = mesh_of(files["measurement"]), observed_mode(kind)
    P = stress_at_common_F(found, mesh.centres, F)
    judged = Judgement({"mode_F": F, "P_identified": P})
    if "constrained" in files:
        field = material_of(files["constrained"])
        P_field = stress_at_common_F(field, mesh.centres, F[observed : observed + 1])[0]
        if files["material"].attrs["material_kind"] == "node":
            # Where a line cuts a cell, networks have the material of most of it, and the field that of the point.
            whole = mesh.areas * ~cut_by_lines(files["constrained"])
            judged |= score_networks(P[observed], P_field, whole if whole.any() else mesh.areas)
    if true is None:
        return judged, None
    truth, P_true = files["truth"], stress_at_common_F(true, mesh.centres, F)
    phase = truth["phase"].values[nearest_cell(truth)(mesh.centres)]
    judged |= score_stress(mesh, P, P_true, phase, len(json.loads(truth.attrs["phases"])), observed)
    means = cell_means(truth, true, mesh, F[observed : observed + 1])
    if means is not None:
        own = P[observed : observed + 1]
        if "constrained" in files:
            own = means_where_cut(found, mesh, cut_by_lines(files["constrained"]), own, F[observed : observed + 1])
        judged |= Judgement(summary={"stress_error_cell_mean": relative_error(own[0], means[0], mesh.areas)})
    if "constrained" in files:
        error = relative_error(P_field, P_true[observed], mesh.areas)
        judged |= Judgement(summary={"stress_error_constrained": error})
    return judged, phase > 0
