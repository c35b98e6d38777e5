"""What was found out about a folder, in numbers for machines."""

import math

import numpy as np

from hypernode.dic.noise.steps import StepNoise
from hypernode.inspection.field import Field, mean_gradients
from hypernode.inspection.folder import Inspection
from hypernode.inspection.known import Remark
from hypernode.inspection.records import RecordFile


def as_json(seen: Inspection) -> dict:
    """What strict JSON can hold: None in place of what is not a finite number."""
    known = seen.known
    return _strict(
        {
            "folder": str(seen.folder),
            "name": seen.name,
            "importable": seen.sheet is not None,
            "frames": None if seen.field is None else _frames(seen.field),
            "load": None if seen.load is None else _load(seen),
            "noise": None if seen.sheet is None else _noise(seen.sheet.cases[0].noise),
            "pictures": len(seen.content.pictures),
            "records": [_record(file) for file in seen.files],
            "clock": [{"seconds": o.seconds, "uncertainty": o.uncertainty, "by": o.by} for o in seen.offsets],
            "steps": [] if seen.sheet is None else _steps(seen),
            "specimen": {"folder": str(seen.folder), **known.settings},
            "guesses": dict(known.guesses),
            "odd": _remarks(known.odd),
            "missing": _remarks(known.missing),
        }
    )


def _remarks(remarks: tuple[Remark, ...]) -> list[dict]:
    return [{"key": each.key, "sentence": each.sentence} for each in remarks]


def _frames(field: Field) -> dict:
    return {
        "software": field.software,
        "format": field.dialect,
        "unit": field.series.unit,
        "y_points": field.y_points,
        "numbers": field.numbers,
        "absent": field.absent,
        "absent_count": field.absent_count,
        "points": [len(field.series.x), len(field.series.y)],
        "step": field.step,
        "extent": field.extent,
        "tilt": field.series.tilt,
        "notes": field.notes,
        "out_of_plane": field.series.out_of_plane if field.stereo else None,
        "lost": [{"frame": lost.frame, "outline": lost.outline, "inside": lost.inside} for lost in field.lost],
    }


def _load(seen: Inspection) -> dict:
    return {
        "kind": seen.load.kind,
        "reason": seen.load.reason,
        "frame": seen.load.frame,
        "mean_gradient": mean_gradients(seen.kept).tolist(),
    }


def _noise(noise: StepNoise) -> dict:
    return {"scatter_mm": noise.scatter.tolist(), "independent_mm": noise.level.tolist(), "source": noise.source}


def _record(file: RecordFile) -> dict:
    cycles = [
        {
            "set": each.set_name,
            "cycle": each.cycle,
            "samples": len(each.record.force),
            "time": None if each.record.time is None else [each.record.time[0], each.record.time[-1]],
            "channels": each.record.channels,
            "force": [[values.min(), values.max()] for values in each.record.force.T],
        }
        for each in file.cycles
    ]
    return {"file": file.path.name, "program": file.program, "refusal": file.refusal or None, "cycles": cycles}


def _steps(seen: Inspection) -> list[dict]:
    case = seen.sheet.cases[0]
    return [
        {
            "frame": number,
            "stretch": case.stretch[k],
            "force": {"xy"[i] + "xy"[J]: force[k] for (i, J), force in case.force.items()},
        }
        for k, number in enumerate(case.numbers)
    ]


def _strict(value):
    if isinstance(value, dict):
        return {key: _strict(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [_strict(inner) for inner in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value
