"""LaVision DaVis exports: one semicolon-separated file a frame, pixels, y downward."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from hypernode.dic.errors import DicError

FRAME = re.compile(r"^(?P<series>.*?)(?P<number>\d{4,})\.csv$")
COLUMNS = ("x [pixel]", "y [pixel]", "x-displacement [pixel]", "y-displacement [pixel]")
#: Largest file that is read; a frame of ten million points is far below it.
MAX_BYTES = 2_000_000_000


@dataclass(frozen=True)
class Frame:
    """Displacements of one frame on the series' grid, pixels, y upward, NaN where lost."""

    number: int
    displacement: Float[np.ndarray, "row column 2"]


@dataclass(frozen=True)
class Series:
    """Every frame of a test on one grid.

    Attributes:
        x, y: grid coordinates in pixels, increasing, y upward from the lowest row.
        frames: in order of their number; the first is the reference.
    """

    x: Float[np.ndarray, " column"]
    y: Float[np.ndarray, " row"]
    frames: list[Frame]

    @property
    def lost(self) -> Bool[np.ndarray, "row column"]:
        """Points lost in any frame after the reference."""
        return np.any([np.isnan(f.displacement).any(axis=-1) for f in self.frames[1:]], axis=0)


def frame_files(folder: Path) -> dict[int, Path]:
    """Frame number -> file of the one series in a folder.

    Raises:
        DicError: there is no folder, no frame, or more than one series.
    """
    if not folder.is_dir():
        raise DicError(f"{folder}: no such folder")
    series: dict[str, dict[int, Path]] = {}
    for path in sorted(folder.iterdir()):
        if match := FRAME.match(path.name):
            frames = series.setdefault(match["series"], {})
            number = int(match["number"])
            if number in frames:
                raise DicError(f"{path}: frame {number} is there twice ({frames[number].name})")
            frames[number] = path
    if not series:
        raise DicError(f"{folder}: no frames: expected files such as Name0001.csv")
    if len(series) > 1:
        raise DicError(f"{folder}: several series ({', '.join(sorted(series))}): keep one a folder")
    return dict(sorted(next(iter(series.values())).items()))


def read_points(path: Path) -> Float[np.ndarray, "point 4"]:
    """Columns x, y, u_x, u_y of one frame, in pixels, y downward as exported.

    Raises:
        DicError: the file is not such an export; the message names the line.
    """
    if path.stat().st_size > MAX_BYTES:
        raise DicError(f"{path}: larger than {MAX_BYTES} bytes: not a frame export")
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise DicError(f"{path}: cannot be read as text: {error}") from None
    lines = text.splitlines()
    if not lines:
        raise DicError(f"{path}:1: the file is empty")
    header = [name.strip() for name in lines[0].split(";")]
    if len(header) < 4:
        raise DicError(f"{path}:1: the header must be separated by ';', found {lines[0][:60]!r}")
    missing = [name for name in COLUMNS if name not in header]
    if missing:
        raise DicError(
            f"{path}:1: no column {missing[0]!r} among {header}: export positions and displacements in pixels"
        )
    index = [header.index(name) for name in COLUMNS]
    points = np.empty((len(lines) - 1, 4))
    count = 0
    for number, line in enumerate(lines[1:], start=2):
        if not line.strip():
            continue
        fields = line.split(";")
        if len(fields) != len(header):
            raise DicError(f"{path}:{number}: {len(fields)} fields, the header has {len(header)}")
        try:
            values = [float(fields[k]) for k in index]
        except ValueError:
            hint = " (decimal comma? export with decimal points)" if "," in line else ""
            raise DicError(f"{path}:{number}: not a number in {line[:60]!r}{hint}") from None
        if not np.isfinite(values[:2]).all():
            raise DicError(f"{path}:{number}: the position is not finite")
        points[count] = values
        count += 1
    if count == 0:
        raise DicError(f"{path}:2: no points")
    return points[:count]


def _axis(values, path, name):
    """Grid coordinates and spacing along one axis, allowing for missing points."""
    lines = np.unique(values)
    if len(lines) < 4:
        raise DicError(f"{path}: only {len(lines)} distinct {name} positions: no grid")
    steps = np.diff(lines)
    step = np.median(steps)
    if np.any(np.abs(steps / step - np.round(steps / step)) > 0.02):
        bad = int(np.argmax(np.abs(steps / step - np.round(steps / step))))
        raise DicError(f"{path}: {name} = {lines[bad + 1]:g} is off the grid of step {step:g} pixel")
    return lines


def read_series(folder: Path, numbers=None) -> Series:
    """Read the frames of a folder onto one grid.

    A point that is left out, not finite, or exported with exactly zero displacement in a deformed
    frame is lost (NaN).

    Args:
        folder: the folder.
        numbers: frames to read besides the reference; all when left out.

    Raises:
        DicError: missing frames, ragged or duplicate points, points off the reference's grid.
    """
    files = frame_files(folder)
    reference = next(iter(files))
    wanted = list(files) if numbers is None else [reference, *sorted(set(numbers) - {reference})]
    absent = [n for n in wanted if n not in files]
    if absent:
        near = min(files, key=lambda n: abs(n - absent[0]))
        raise DicError(f"{folder}: frame {absent[0]} is not there; the nearest is {near}")
    first = read_points(files[reference])
    x, y = _axis(first[:, 0], files[reference], "x"), _axis(first[:, 1], files[reference], "y")
    frames = []
    for number in wanted:
        points = read_points(files[number])
        column, row = np.searchsorted(x, points[:, 0]), np.searchsorted(y, points[:, 1])
        known = (column < len(x)) & (row < len(y))
        known[known] &= (x[column[known]] == points[known, 0]) & (y[row[known]] == points[known, 1])
        if not known.all():
            bad = int(np.flatnonzero(~known)[0])
            raise DicError(
                f"{files[number]}:{bad + 2}: the point {points[bad, :2]} is not on the grid of frame {reference}"
            )
        place = row * len(x) + column
        unique, counts = np.unique(place, return_counts=True)
        if (counts > 1).any():
            again = np.flatnonzero(place == unique[np.argmax(counts)])[1]
            raise DicError(f"{files[number]}:{again + 2}: the point {points[again, :2]} is there twice")
        grid = np.full((len(y) * len(x), 2), np.nan)
        u = points[:, 2:].copy()
        if number != reference:
            u[(u == 0.0).all(axis=1)] = np.nan
        u[~np.isfinite(u).all(axis=1)] = np.nan
        grid[place] = u
        # Rows run downward in the export: turn both the rows and the vertical displacement over.
        grid = grid.reshape(len(y), len(x), 2)[::-1] * np.array([1.0, -1.0])
        frames.append(Frame(number, grid))
    return Series(x - x[0], (y[-1] - y)[::-1], frames)
