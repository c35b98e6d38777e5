"""A measurement file as a folder of frames, a force record and the configuration that imports them again."""

import re
from pathlib import Path

import numpy as np
import xarray as xr

from hypernode.config.specimen_tests import FORCE_ERRORS
from hypernode.config.yaml_text import yaml_value
from hypernode.data.measurement import correlation_window, displacement_noise, mesh_of
from hypernode.dic.errors import DicError
from hypernode.dic.recorded import RecordedTest, recorded_tests
from hypernode.dic.writing import write_force_record, write_series
from hypernode.storage.netcdf import EXPERIMENT_UNITS, read, units_of

#: Frames in a second of an export, whose frames are the load steps: the clock counts them.
FRAME_RATE = 1.0
#: Share of a side by which steps of an equidistant grid may differ: the rounding of its lines.
EQUIDISTANT = 1e-9


def run(measurement_file: str | Path, folder: str | Path) -> Path:
    """Write FOLDER/test<k>/frame<number>.csv and force_disp.csv of every load case, and FOLDER/specimen.yaml.

    Displacements are the means over the repeats. Forces are those of an elastic sheet. The part of a record that is a
    matter of time is taken away, since it cannot be told again from the load steps of an export.

    Returns:
        The configuration.

    Raises:
        StorageError: the measurement cannot be read.
        DicError: the folder holds something, or the file no displacements or forces.
    """
    measurement_file, folder = Path(measurement_file), Path(folder)
    measurement = read(measurement_file)
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise DicError(f"{folder}: holds something already: name a new folder")
    if "u_measured" not in measurement:
        raise DicError(f"{measurement_file}: is no measurement: it holds no u_measured")
    tests = recorded_tests(measurement, measurement_file)
    for k, test in enumerate(tests):
        write_series(test.series, folder / f"test{k}")
        time = np.array([frame.number / FRAME_RATE for frame in test.series.frames])
        if test.force:
            write_force_record(folder / f"test{k}" / "force_disp.csv", time, test.displacement, test.force)
    path = folder / "specimen.yaml"
    path.write_text(_configuration(measurement, measurement_file, folder, tests), encoding="utf-8")
    return path


def _configuration(measurement: xr.Dataset, path: Path, folder: Path, tests: list[RecordedTest]) -> str:
    """The text of the configuration that imports an export again."""
    name = re.sub(r"[^A-Za-z0-9_.-]", "_", path.resolve().parent.name).lstrip("_.-") or "export"
    attributes, (width, height) = measurement.attrs, mesh_of(measurement).size.tolist()
    window, kernel = correlation_window(measurement)
    sheet = {
        "source_title": f"export of {path.name} of {name}",
        "width": width,
        "height": height,
        "thickness": float(attributes["thickness"]),
        # A specimen has some: here that of rounding.
        "noise_mm": float(displacement_noise(measurement) or np.finfo(float).eps * max(width, height)),
        "outline": attributes["outline"],
        "edge_ring": 0,
        "mesh": attributes.get("mesh", "finer"),
        "noise_uncertainty": float(attributes.get("noise_uncertainty", 0.05)),
        "correlation_window": window,
        "correlation_kernel": kernel,
        **{key: float(attributes[key]) for key in FORCE_ERRORS},
    }
    entries = [
        {
            "folder": str(folder / f"test{k}"),
            "format": "table",
            "table": {"unit": "mm"},
            "load": test.load,
            "force_file": "force_disp.csv" if test.force else None,
            "frame_rate": FRAME_RATE,
            "frames": [frame.number for frame in test.series.frames[1:]],
            "relaxation": False,
        }
        for k, test in enumerate(tests)
    ]
    lines = [*_remarks(measurement, path), "specimens:", f"  {name}:"]
    together = sheet | entries[0] if len(tests) == 1 else sheet
    lines += [f"    {key}: {yaml_value(value)}" for key, value in together.items()]
    if len(tests) > 1:
        lines.append("    tests:")
        for entry in entries:
            lines += [
                f"      {'-' if key == 'folder' else ' '} {key}: {yaml_value(value)}" for key, value in entry.items()
            ]
    return "\n".join([*lines, ""])


def _remarks(measurement: xr.Dataset, path: Path) -> list[str]:
    """What a reader of the export must know, as comments."""
    lines = [f"# Exported from {path}: lengths in mm, forces in N; time counts the load steps."]
    if units_of(measurement) != EXPERIMENT_UNITS:
        lines += [
            "# The sheet is synthetic: its length has no unit and its stress is in Pa. Its numbers are written as they",
            "# are, so that a length of 1 stands as 1 mm, a stress of 1 Pa as 1 MPa, and a force of 1 Pa as 1 N.",
        ]
    if displacement_noise(measurement) == 0.0:
        lines.append("# It was measured without noise: noise_mm is the rounding of its numbers.")
    factors = measurement["relaxation"].values
    if (factors != 1.0).any():
        lines += [
            "# What of the recorded force is a matter of time is taken away; recorded over elastic force by load step:",
            f"# {', '.join(f'{factor:.6g}' for factor in factors)}.",
        ]
    mesh = mesh_of(measurement)
    if len(mesh.cells) < np.prod([len(line) - 1 for line in mesh.lines]):
        lines.append("# Points without material are empty in every frame: declare the hole in the case.")
    if any(np.ptp(np.diff(line)) > EQUIDISTANT * (line[-1] - line[0]) for line in mesh.lines):
        lines.append("# The grid is graded: an import interpolates it onto an equidistant one.")
    return lines
