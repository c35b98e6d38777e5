"""The measured points of one frame, back in the reference sheet."""

import functools
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from hypernode.dic.dialect import Dialect
from hypernode.dic.errors import DicError
from hypernode.dic.header import LENGTHS
from hypernode.dic.table import read_table

#: Length in mm or pixels from which it is none, as 1e308 that stands for a lost point.
_ENDLESS = 1e12
#: Distance of a point of the reference from its neighbour, over that of the points in the median, from which its
#: position is a mistake: a lost decimal sign makes it ten times as large.
_STRAY = 10.0
#: Units of displacements that are shares of a side of the sheet.
_PER_CENT = ("%", "percent", "per cent", "prozent")


@dataclass(frozen=True, kw_only=True)
class Points:
    """Measured points of one frame, as its file gives them. A third component is out of plane.

    Attributes:
        position: in the reference sheet.
        displacement: NaN where lost.
        line: of each point in its file.
        unit: ``pixel`` or ``mm``.
        moving: words of the command line that say that positions are in the deformed sheet.
    """

    path: Path
    position: Float[np.ndarray, "point axis"]
    displacement: Float[np.ndarray, "point axis"]
    line: Int[np.ndarray, " point"]
    unit: str
    time: float | None = None
    force: float | None = None
    crosshead: float | None = None
    moving: str = ""


def unit_of(path: Path, units: dict[str, str], preamble: list[str], dialect: Dialect) -> tuple[str, float, float]:
    """(unit of the series, factors to it of positions and of displacements) that a file names.

    Raises:
        DicError: no unit is named, an unknown one, or positions and displacements are not both lengths or both pixels.
    """
    named = {role: units[role].strip() for role in ("x", "y", "u", "v") if units[role].strip()}
    if dialect.preamble_unit:
        found = [match[1] for line in preamble if (match := re.search(dialect.preamble_unit, line))]
        named |= {f"preamble {unit}": unit for unit in found}
    if not named and dialect.unit:
        named = {"all": dialect.unit}
    if not named and dialect.content == "arrays":
        raise DicError(
            f"{path}: no unit is named: say --set 'arrays={{unit: mm}}', or unit: pixel with "
            "--pixel-size; metres are pixels of 1000 mm"
        )
    if not named:
        raise DicError(f"{path}: no unit is named: say {dialect.option(unit='mm')}, or unit: pixel")
    shares = {role for role in "uv" if named.get(role, "").lower() in _PER_CENT}
    if shares and dialect.displacement_factor == 1.0:
        raise DicError(
            f"{path}: displacements in {named[min(shares)]!r}: say what one per cent is in the unit of the positions, "
            "--set displacement_factor=N, 0.24 of a side of 24 mm"
        )
    named = {role: unit for role, unit in named.items() if role not in shares}
    unknown = sorted(name for name in named.values() if name.lower() not in LENGTHS)
    if unknown:
        raise DicError(f"{path}: lengths in {unknown[0]!r}: export positions and displacements in mm or pixels")
    known = {role: LENGTHS[name.lower()] for role, name in named.items()}
    factors = [{known[role] for role in known if role not in others} for others in ("uv", "xy")]
    if len({unit for unit, _ in known.values()}) > 1 or max(map(len, factors)) > 1:
        every = ", ".join(sorted(set(named.values())))
        # A factor that is said takes displacements into the unit of the positions.
        if dialect.displacement_factor == 1.0 or len(factors[0]) != 1:
            raise DicError(
                f"{path}: positions and displacements in different units ({every}): say what displacements are "
                "multiplied by to be in the unit of the positions, --set displacement_factor=N: pixels in a mm, or mm "
                "in a pixel; or name other columns, with their units, format: table"
            )
    told = [next(iter(each or set(known.values()))) for each in factors]
    return told[0][0], told[0][1], told[1][1]


def read_points(path: Path, dialect: Dialect) -> Points:
    """The points of one frame.

    Raises:
        DicError: the file is not of this dialect or holds increments; the message names the line.
    """
    cells, line, units, preamble = read_table(path, dialect)
    return points_from(path, cells, line, units, preamble, dialect)


def points_from(path: Path, cells, line, units, preamble, dialect: Dialect) -> Points:
    """Points from the columns of :func:`read_table`, back in the reference, without those whose position is unknown."""
    for number, text in enumerate(preamble, start=1):
        if dialect.incremental and dialect.incremental.lower() in text.lower():
            raise DicError(
                f"{path}:{number}: displacements from frame to frame, not from the reference: correlate again with "
                "the first image as the reference"
            )
    unit, *factors = unit_of(path, units, preamble, dialect)
    position = np.stack([cells[role] for role in "xyz" if role in cells], axis=1) * factors[0]
    u = np.stack([cells[role] for role in "uvw" if role in cells], axis=1)
    u *= factors[1]
    u[:, :2] = _along_axes(u[:, :2], dialect.displacement_axes)
    u = (u - position if dialect.positions else u) * dialect.displacement_factor
    for column, value in dialect.lost:
        if column in cells:
            u[cells[column] == value] = np.nan
    if "failed" in cells:
        u[cells["failed"]] = np.nan
    u[~_all(np.abs(u) < _ENDLESS) | _no_lengths(position, u)] = np.nan
    if dialect.deformed:
        position = position - u
    known, blank = _all(np.abs(position) < _ENDLESS), _blank(cells)
    keep = known & ~blank
    if not dialect.lost_position:
        keep &= _all(np.isfinite(u))
    elif not known.all():
        raise DicError(f"{path}:{line[np.argmin(known)]}: the position is not finite")
    if not keep.any():
        raise DicError(f"{path}: every point is lost")
    time = float(cells[dialect.time][0]) if dialect.time in cells else None
    force = float(cells[dialect.force][0]) if dialect.force in cells else None
    if dialect.preamble_force:
        found = [match[1] for text in preamble if (match := re.search(dialect.preamble_force, text))]
        force = float(found[0]) if found else None
    moving = dialect.option(unit=unit, deformed="true")
    return Points(
        path=path,
        position=position[keep],
        displacement=u[keep],
        line=line[keep],
        unit=unit,
        time=time,
        force=force,
        moving=moving,
    )


def _blank(cells) -> np.ndarray:
    """Rows that hold nothing but zeros, where there are several: a program fills what it lost with them."""
    zeros = functools.reduce(np.logical_and, [cells[role] == 0.0 for role in "xyuv"])
    return zeros if zeros.sum() > 1 else np.zeros(len(zeros), dtype=bool)


def _along_axes(u: np.ndarray, axes: tuple[str, str]) -> np.ndarray:
    """Displacements (point, 2) along x and y, of columns that point along these axes."""
    turned = np.empty_like(u)
    for k, axis in enumerate(axes):
        turned[:, "xy".index(axis[-1])] = -u[:, k] if axis.startswith("-") else u[:, k]
    return turned


def _all(components: np.ndarray) -> np.ndarray:
    """Which points have all components so; numpy's own is slow along a short axis."""
    return functools.reduce(np.logical_and, components.T)


def _no_lengths(position: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Which displacements are one number in all components, beyond the field: -999 and 1e30 stand for none."""
    one = _all(np.abs(u) == np.abs(u[:, :1])) & (u[:, 0] != 0.0)
    return one & (np.abs(u[:, 0]) > 2.0 * np.ptp(position, axis=0).max()) if one.any() else one


def refuse_strays(points: Points) -> None:
    """Nothing, where every point of the reference has a neighbour.

    Raises:
        DicError: a point lies far from all others, as one does whose position is written wrongly.
    """
    if len(points.position) < 3:
        return
    # Half a second, which every reading of the configuration would pay.
    from scipy.spatial import cKDTree

    distance = cKDTree(points.position[:, :2]).query(points.position[:, :2], k=2)[0][:, 1]
    far = int(np.argmax(distance))
    if distance[far] > _STRAY * np.median(distance) > 0.0:
        place = " ".join(f"{value:g}" for value in points.position[far])
        raise DicError(
            f"{points.path}:{points.line[far]}: the point [{place}] lies {distance[far]:.4g} {points.unit} from every "
            f"other, and those are {np.median(distance):.4g} {points.unit} apart: correct its position or leave it out"
        )
