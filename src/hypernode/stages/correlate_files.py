"""Pictures of a real test become a folder of displacement files and a force record, as of other software."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hypernode.config.correlation import Correlation
from hypernode.dic.correlated import series_of
from hypernode.dic.errors import DicError
from hypernode.dic.forces.record import ForceRecord, read_force_record
from hypernode.dic.series import Series
from hypernode.dic.writing import write_force_record, write_series
from hypernode.pictures.correlation import correlate
from hypernode.pictures.files import Region, picture_files, read_pictures, region_mask, seconds_of
from hypernode.pictures.window import window_of
from hypernode.storage.records import sha256

#: What says how the files of a folder came about; no displacement file.
RECORD = "correlation.json"


@dataclass(frozen=True, kw_only=True)
class Photographs:
    """Pictures of a test and what is known of them.

    Attributes:
        folder, pattern: where they are, and how they are named.
        reference: ``first`` or ``last`` of the names.
        every: how many of them one is taken of.
        mm_per_pixel: on the sheet.
        region, mask: what to follow, see :func:`region_mask`.
        force_file: the machine's record in that folder; its set and cycle, where it has several.
    """

    folder: Path
    pattern: str
    mm_per_pixel: float
    reference: str = "first"
    every: int = 1
    region: Region | None = None
    mask: Path | None = None
    force_file: str | None = None
    force_set: str | None = None
    force_cycle: str | None = None


def run(photographs: Photographs, settings: Correlation, output: Path, threads: int = 1) -> dict:
    """Write OUTPUT/frame<number>.csv in mm, y upward, OUTPUT/force_disp.csv and OUTPUT/correlation.json.

    Where the pictures' names end in their times, those of the frames do, as in ``frame_2.400 s.csv``. They count from
    the reference on, backward in a test whose least loaded picture is the last.

    Returns:
        What correlation.json says.

    Raises:
        DicError: the folder holds something already, or the record does not cover the pictures.
        PictureError: pictures cannot be read or compared, or the engine is not there.
    """
    if output.exists() and (not output.is_dir() or any(output.iterdir())):
        raise DicError(f"{output}: holds something already: name a new folder")
    paths = picture_files(photographs.folder, photographs.pattern, photographs.reference, photographs.every)
    pictures = read_pictures(paths)
    record = _record(photographs, paths)
    found = correlate(
        pictures, region_mask(pictures.shape[1:], photographs.region, photographs.mask), settings, threads
    )
    upward = np.array([1.0, -1.0]) * photographs.mm_per_pixel
    position = np.stack([found.column, found.row], axis=1) * upward
    series, _ = series_of(paths[0], position, found.displacement * upward)
    frames = write_series(Series(series.x, series.y, series.frames, unit="mm"), output)
    times = seconds_of(paths)
    if times is not None:
        for frame, time in zip(frames, np.round(np.abs(times - times[0]), 6), strict=True):
            frame.rename(output / f"frame_{time:.3f} s.csv")
    if record:
        _write_forces(record, paths, output)
    side, kernel = window_of(settings)
    said = {
        "correlation": settings.model_dump(mode="json"),
        "mm_per_pixel": photographs.mm_per_pixel,
        "correlation_window": side * photographs.mm_per_pixel,
        "correlation_kernel": kernel,
        "points": len(found.column),
        "followed": np.isfinite(found.displacement).all(axis=-1).sum(axis=1).tolist(),
        "median_correlation": np.nanmedian(found.correlation, axis=1).tolist(),
        "pictures": {path.name: sha256(path) for path in paths},
    }
    (output / RECORD).write_text(json.dumps(said, indent=1) + "\n")
    return said


def _record(photographs: Photographs, paths: list[Path]) -> ForceRecord | None:
    """The force record, where there is one, if it covers the times of all pictures."""
    if photographs.force_file is None:
        return None
    path = photographs.folder / photographs.force_file
    record = read_force_record(path, None, None, photographs.force_set, photographs.force_cycle)
    times = seconds_of(paths)
    if times is None or record.time is None:
        raise DicError(
            f"{path}: forces are found by time, and not every picture's name ends in its seconds, as _12.5.tif does"
        )
    if times.min() < record.time[0] or times.max() > record.time[-1]:
        raise DicError(
            f"{path}: pictures were taken at {times.min():.6g} to {times.max():.6g} s, the record holds "
            f"{record.time[0]:.6g} to {record.time[-1]:.6g} s"
        )
    return record


def _write_forces(record: ForceRecord, paths: list[Path], output: Path) -> None:
    """The record at the times of the pictures, from the reference on."""
    times = seconds_of(paths)
    force = {axis: np.interp(times, record.time, record.force[:, k]) for k, axis in enumerate(record.axes)}
    # Without a number the column reads as not recorded.
    moved = {axis: np.full(len(times), np.nan) for axis in record.axes}
    if record.displacement is not None:
        for k, axis in enumerate(record.axes):
            at = np.interp(times, record.time, record.displacement[:, k])
            moved[axis] = at - at[0]
    write_force_record(output / "force_disp.csv", np.round(np.abs(times - times[0]), 6), moved, force)
