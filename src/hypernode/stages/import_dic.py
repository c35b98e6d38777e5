"""Stage 2 for a real test: a folder of frames and a force record become a measurement file."""

import numpy as np

from hypernode.config.model import Config
from hypernode.dic.specimen import import_test
from hypernode.storage.netcdf import EXPERIMENT_UNITS, sha256, write
from hypernode.synthetic.geometry import make_shape


def run(config: Config, name: str, output: str, attributes: dict) -> None:
    """Import a specimen: mm, N and MPa, y upward.

    Raises:
        DicError: any input that cannot be used, with file and line.
    """
    case = config.cases[name]
    specimen = config.specimens[case.specimen]
    test = import_test(specimen, make_shape(config.geometries[case.hole]) if case.hole else None)
    mesh, relaxation = test.mesh, test.relaxation
    write(
        output,
        {
            "X": mesh.nodes,
            "cells": mesh.cells,
            "corners": np.stack([mesh.lower, mesh.upper]),
            "load_case": np.zeros(len(test.numbers), dtype=np.int64),
            "stretch": 1.0 + test.H[:, test.axis, test.axis],
            "H": test.H,
            "time": test.time,
            "edge_force": test.edge_force,
            "relaxation": relaxation.at(test.time),
            "relaxation_time": relaxation.times,
            "relaxation_factor": relaxation.factor,
            "edge_constrained": test.constrained,
            "u_measured": test.u[None],
        },
        f"measurement of specimen {specimen.source_title or name}",
        {
            **attributes,
            "units": EXPERIMENT_UNITS,
            "load_cases": [specimen.load],
            # Correlation windows never reach the edge of the sheet.
            "outline": "cut",
            "thickness": specimen.thickness,
            "displacement_noise": specimen.displacement_noise,
            "force_uncertainty": specimen.force_uncertainty,
            "correlation_window": specimen.correlation_window,
            "frames": test.numbers.tolist(),
            "elastic_terms": list(relaxation.terms),
            "pace": relaxation.pace,
            "field_corners": test.field.tolist(),
            "lost_points": test.lost_points,
            "force_findings": list(test.force_findings),
            "raw_inputs": {str(path): sha256(path) for path in test.files},
        },
    )
