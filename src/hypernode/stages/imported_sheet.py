"""What a measurement file holds of a sheet that was imported: a real one, or one whose pictures were correlated."""

import numpy as np
from jaxtyping import Float

from hypernode.config.specimen_tests import FORCE_ERRORS
from hypernode.config.specimens import Specimen
from hypernode.dic.noise.steps import StepNoise
from hypernode.dic.specimen import ImportedSpecimen

#: Of what engines of image correlation see about the mean over their window, over what that mean changes: pyvale and
#: al-dic with affine subsets, of three sheets at four stretches 0.20 to 0.31 (docs/decisions/0060).
WINDOW_UNCERTAINTY = 0.25


def variables_of(sheet: ImportedSpecimen, corner: Float[np.ndarray, " 2"]) -> dict[str, np.ndarray]:
    """The variables of its measurement.

    Args:
        corner: where the lower left corner of the measured field lies.
    """
    mesh, courses = sheet.mesh, [each.relaxation.sampled() for each in sheet.cases]
    times, factors = (np.stack([course[k] for course in courses]) for k in (0, 1))
    return {
        "X": mesh.nodes + corner,
        "cells": mesh.cells,
        "corners": np.stack([mesh.lower, mesh.upper]) + corner,
        "load_case": sheet.load_case,
        "stretch": sheet.stretch,
        "H": sheet.H,
        "time": np.concatenate([each.time for each in sheet.cases]),
        "edge_force": sheet.edge_force,
        "force_pairing_uncertainty": np.concatenate([each.pairing for each in sheet.cases]),
        "force_relaxation_uncertainty": np.concatenate([each.relaxation.open_at(each.time) for each in sheet.cases]),
        "relaxation": np.concatenate([each.relaxation.at(each.time) for each in sheet.cases]),
        "relaxation_time": times,
        "relaxation_factor": factors,
        "edge_constrained": sheet.constrained,
        "u_measured": sheet.u[None],
        "relative_thickness": sheet.relative_thickness,
        "noise_scatter": np.concatenate([each.noise.scatter for each in sheet.cases]),
        "noise_level": np.concatenate([each.noise.level for each in sheet.cases]),
        **_of_frames([each.noise for each in sheet.cases]),
        "camera_angle": np.degrees(np.concatenate([each.camera_angle for each in sheet.cases])),
    }


def _of_frames(noises: list[StepNoise]) -> dict[str, np.ndarray]:
    """The noise that frames tell, of load cases of which one has another one stated; of the others their own."""
    if all(noise.frames is None for noise in noises):
        return {}
    told = [noise.frames or noise for noise in noises]
    return {
        f"frames_noise_{key}": np.concatenate([getattr(each, key) for each in told]) for key in ("scatter", "level")
    }


def attributes_of(specimen: Specimen, sheet: ImportedSpecimen, corner: Float[np.ndarray, " 2"]) -> dict:
    """What its measurement says of itself, but for units, loads and raw files."""
    return {
        "outline": specimen.outline,
        "mesh": specimen.mesh,
        "thickness": specimen.thickness,
        "plane": specimen.plane,
        "noise_sources": [each.noise.source for each in sheet.cases],
        "noise_uncertainty": specimen.noise_uncertainty,
        "outliers": sheet.outliers,
        **{key: max(getattr(each.test, key) for each in sheet.cases) for key in FORCE_ERRORS},
        "correlation_window": specimen.correlation_window,
        "correlation_kernel": specimen.correlation_kernel,
        "window_uncertainty": WINDOW_UNCERTAINTY,
        "frames": [each.numbers.tolist() for each in sheet.cases],
        "pace": [each.relaxation.pace for each in sheet.cases],
        "field_corners": (sheet.field + corner).tolist(),
        "thickness_uncertainty": specimen.thickness_uncertainty,
        "pixel_size_uncertainty": specimen.pixel_size_uncertainty,
        "camera_distance_uncertainty": specimen.camera_distance_uncertainty,
        "preload": max(each.preload for each in sheet.cases),
        "seen_share": sheet.shares.tolist(),
        "lost_points": sheet.lost_points,
        "forces": "measured" if sheet.forces_known else "assumed",
        "force_findings": [sentence for each in sheet.cases for sentence in each.findings],
    }
