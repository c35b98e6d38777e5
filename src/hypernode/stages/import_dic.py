"""Stage 2 for a real sheet: folders of frames and force records become a measurement file."""

import numpy as np

from hypernode.config.model import Config
from hypernode.config.specimen_tests import FORCE_ERRORS
from hypernode.dic.specimen import ImportedSpecimen, import_specimen
from hypernode.storage.netcdf import EXPERIMENT_UNITS, sha256, write
from hypernode.synthetic.geometry import make_shape

#: Relative uncertainty of a noise that was estimated from frames or stated for a test: estimates on synthetic frames
#: of known noise scatter by as much.
NOISE_UNCERTAINTY = 0.05


def run(config: Config, name: str, output: str, attributes: dict) -> None:
    """Import a specimen: mm, N and MPa, y upward.

    Raises:
        DicError: any input that cannot be used, with file and line.
    """
    case = config.cases[name]
    specimen = config.specimens[case.specimen]
    sheet = import_specimen(specimen, make_shape(config.geometries[case.hole]) if case.hole else None)
    write(
        output,
        _variables(sheet),
        f"measurement of specimen {specimen.source_title or name}",
        {
            **attributes,
            "units": EXPERIMENT_UNITS,
            "load_cases": [each.test.load for each in sheet.cases],
            "outline": specimen.outline,
            "grid": "measured",
            "thickness": specimen.thickness,
            "noise_sources": [each.noise.source for each in sheet.cases],
            "noise_uncertainty": NOISE_UNCERTAINTY,
            "outliers": sheet.outliers,
            **{key: max(getattr(each.test, key) for each in sheet.cases) for key in FORCE_ERRORS},
            "correlation_window": specimen.correlation_window,
            "frames": [each.numbers.tolist() for each in sheet.cases],
            "elastic_terms": [list(each.relaxation.terms) for each in sheet.cases],
            "pace": [each.relaxation.pace for each in sheet.cases],
            "field_corners": sheet.field.tolist(),
            "lost_points": sheet.lost_points,
            "forces": "measured" if sheet.forces_known else "assumed",
            "force_findings": [sentence for each in sheet.cases for sentence in each.findings],
            "raw_inputs": {str(path): sha256(path) for path in sheet.files},
        },
    )


def _variables(sheet: ImportedSpecimen) -> dict:
    mesh, courses = sheet.mesh, [each.relaxation.sampled() for each in sheet.cases]
    times, factors = (np.stack([course[k] for course in courses]) for k in (0, 1))
    return {
        "X": mesh.nodes,
        "cells": mesh.cells,
        "corners": np.stack([mesh.lower, mesh.upper]),
        "load_case": sheet.load_case,
        "stretch": sheet.stretch,
        "H": sheet.H,
        "time": np.concatenate([each.time for each in sheet.cases]),
        "edge_force": sheet.edge_force,
        "relaxation": np.concatenate([each.relaxation.at(each.time) for each in sheet.cases]),
        "relaxation_time": times,
        "relaxation_factor": factors,
        "edge_constrained": sheet.constrained,
        "u_measured": sheet.u[None],
        "relative_thickness": sheet.relative_thickness,
        "noise_scatter": np.concatenate([each.noise.scatter for each in sheet.cases]),
        "noise_level": np.concatenate([each.noise.level for each in sheet.cases]),
        "camera_angle": np.degrees(np.concatenate([each.camera_angle for each in sheet.cases])),
    }
