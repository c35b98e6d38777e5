"""Stage 2 for a real test: a folder of frames and a force record become a measurement file."""

from pathlib import Path

import numpy as np

from hypernode.config.model import Config
from hypernode.dic.davis import Series, frame_files, read_series
from hypernode.dic.errors import DicError
from hypernode.dic.force_record import read_force_record
from hypernode.dic.specimen import _AXIS, _edges, _force_at, _frame_times, _places, _relaxation, _select, _trimmed
from hypernode.fem.gradient import deformation_gradient
from hypernode.fem.mesh import rectilinear
from hypernode.storage.netcdf import EXPERIMENT_UNITS, sha256, write


def run(config: Config, name: str, output: str, attributes: dict) -> None:
    """Import a specimen: mm, N and MPa, y upward, force interpolated at each frame's time.

    Raises:
        DicError: any input that cannot be used, with file and line.
    """
    specimen = config.specimens[config.cases[name].specimen]
    folder = Path(specimen.folder)
    full = read_series(folder, specimen.frames)
    series = _trimmed(full, specimen.edge_ring)
    numbers = _select(specimen, series)
    force_path = folder / specimen.force_file
    record_time, record_force = read_force_record(force_path)
    record = record_time, record_force - specimen.force_offset
    time = _frame_times(specimen, series, numbers)
    force = _force_at(time, numbers, record, force_path)
    relaxation = _relaxation(specimen, series, record)
    by_number = {f.number: f.displacement for f in series.frames}
    chosen = Series(series.x, series.y, [series.frames[0]] + [f for f in series.frames if f.number in numbers])
    valid = ~chosen.lost
    keep = valid[:-1, :-1] & valid[1:, :-1] & valid[:-1, 1:] & valid[1:, 1:]
    if not keep.any():
        raise DicError(f"{folder}: no four neighbouring points are measured in all of the frames {numbers.tolist()}")
    mm = specimen.pixel_size
    mesh = rectilinear(series.x * mm, series.y * mm, keep)
    grid = np.stack(np.meshgrid(series.x * mm, series.y * mm), axis=-1).reshape(-1, 2)
    place = _places(grid, mesh.nodes)
    u = np.stack([by_number[n].reshape(-1, 2)[place] * mm for n in numbers])
    reference = by_number[full.frames[0].number].reshape(-1, 2)[place] * mm
    u = u - np.nan_to_num(reference)
    axis = _AXIS[specimen.load]
    edge_force, constrained = _edges(specimen, mesh, force)
    areas = mesh.areas / mesh.areas.sum()
    F = deformation_gradient(mesh, u)
    folded = (np.linalg.det(F) <= 0).any(axis=1)
    if folded.any():
        raise DicError(
            f"{folder}: frame {numbers[int(np.argmax(folded))]} folds the sheet over (det F is not positive): "
            "leave it out, or export it again"
        )
    H = np.einsum("scij,c->sij", F, areas) - np.eye(2)
    field = np.array([[0.0, 0.0], [full.x[-1] * mm, full.y[-1] * mm]])
    write(
        output,
        {
            "X": mesh.nodes,
            "cells": mesh.cells,
            "corners": np.stack([mesh.lower, mesh.upper]),
            "load_case": np.zeros(len(numbers), dtype=np.int64),
            "stretch": 1.0 + H[:, axis, axis],
            "H": H,
            "time": time,
            "edge_force": edge_force,
            "relaxation": relaxation.at(time),
            "edge_constrained": constrained,
            "u_measured": u[None],
        },
        f"measurement of specimen {specimen.source_title or name}",
        {
            **attributes,
            "units": EXPERIMENT_UNITS,
            "load_cases": [specimen.load],
            # Correlation windows never reach the edge of the sheet.
            "outline": "cut",
            "thickness": specimen.thickness,
            "displacement_noise": specimen.noise_pixels * mm,
            "force_uncertainty": specimen.force_uncertainty,
            "correlation_window": specimen.correlation_window,
            "frames": numbers.tolist(),
            "elastic_terms": list(relaxation.terms),
            "pace": relaxation.pace,
            "field_corners": field.tolist(),
            "lost_points": int((~valid).sum()),
            "raw_inputs": {
                str(path): sha256(path)
                for path in (force_path, *(frame_files(folder)[frame.number] for frame in full.frames))
            },
        },
    )
