"""Force records of testing machines, whatever program wrote them."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from hypernode.dic.dialect import NOT_A_NUMBER
from hypernode.dic.errors import DicError
from hypernode.dic.forces.beside import refuse_volts, section_of
from hypernode.dic.forces.clock_times import with_seconds
from hypernode.dic.forces.dialects import FORCE_UNITS, LENGTH_UNITS, PULL, TIME_UNITS, VOLTS, ForceDialect
from hypernode.dic.forces.numbers import AmbiguousNumbersError, decimal_sign, parse_number
from hypernode.dic.forces.pictures import picture_column, pictures_of
from hypernode.dic.forces.table import Table, choose_cycle, read_table
from hypernode.dic.forces.ticks import read_anew, spread_ticks
from hypernode.dic.series import Series
from hypernode.dic.text import shown


@dataclass(frozen=True, kw_only=True)
class ForceRecord:
    """What a machine recorded.

    Attributes:
        path: of the file.
        dialect: how it is written; None where the frames hold the force themselves.
        time: of every sample, never decreasing [s]; None where only pictures are numbered.
        image: number of the picture that belongs to a sample, NaN where none does; None where none is given.
        axes: of the machine: ("pull",), or ("x", "y").
        force: by sample and axis [N].
        displacement: of the crosshead or actuator by sample and axis [mm]; None where it is not recorded.
        channels: names of the columns of the force.
        section: by which the record divides the one force to give a stress [mm^2]; None where it gives none.
    """

    path: Path
    dialect: ForceDialect | None = None
    time: Float[np.ndarray, " sample"] | None = None
    image: Float[np.ndarray, " sample"] | None
    axes: tuple[str, ...]
    force: Float[np.ndarray, "sample axis"]
    displacement: Float[np.ndarray, "sample axis"] | None
    channels: tuple[str, ...]
    section: float | None = None

    @property
    def program(self) -> str:
        """What wrote it, for messages."""
        return f"{self.dialect.name} ({self.dialect.program})" if self.dialect else "the frames' own force"

    def column(self, axis: str) -> int:
        """Column of the force along "x" or "y": its own, or the only one."""
        return self.axes.index(axis) if axis in self.axes else 0


def read_force_record(
    path: Path,
    dialect: str | None = None,
    channel: str | dict[str, str] | None = None,
    set_name: str | None = None,
    cycle: str | None = None,
    time: str | None = None,
) -> ForceRecord:
    """Read a record; its dialect is recognised by its content.

    Args:
        path: the file.
        dialect: name of the dialect, where it is not recognised.
        channel: name of the column with the force, or that along each axis, where it is not the dialect's own.
        time: name of the column with the time, where it is not the dialect's own.
        set_name, cycle: of the rows that count, where a file holds several cycles.

    Raises:
        DicError: the file, its units or a line cannot be used, or time does not increase.
    """
    path = Path(path)
    named = channel.values() if isinstance(channel, dict) else [channel] if channel else []
    table = choose_cycle(read_table(path, dialect, tuple(named), time), set_name, cycle)
    forces = _force_columns(table, channel)
    at_time = table.find(table.dialect.time) if time is None else _channel(table, time, "time_channel")
    table = _with_a_force(table, list(forces.values()))
    where = (at_time, picture_column(table))
    if at_time is not None:
        table = with_seconds(table, at_time)
    columns = [(at, _scale(table, at, FORCE_UNITS, "force in (N)")) for at in forces.values()]
    if where[0] is not None:
        columns.insert(0, (where[0], _scale(table, where[0], TIME_UNITS, "time in (s)")))
    decimal = _decimal(table, [at for at, _ in columns])
    values = _samples(table, columns, decimal, timed=where[0] is not None)
    if where[0] is not None and where[1] is None:
        table, values = _read_in_time(table, values)
    refuse_volts(table, forces, values[:, -len(forces) :], decimal)
    return ForceRecord(
        path=path,
        dialect=table.dialect,
        time=None if where[0] is None else values[:, 0],
        image=None if where[1] is None else pictures_of(table, where[1], needed=where[0] is None),
        axes=tuple(forces),
        force=values[:, -len(forces) :],
        displacement=_displacement(table, tuple(forces), decimal),
        channels=tuple(table.header[at] for at in forces.values()),
        section=section_of(table, values[:, -1], decimal) if len(forces) == 1 else None,
    )


def record_of_frames(folder: Path, series: Series) -> ForceRecord:
    """The record that frames themselves hold, each with the force at its picture.

    Raises:
        DicError: one of them says none.
    """
    silent = [frame.number for frame in series.frames[1:] if frame.force is None]
    if silent:
        raise DicError(
            f"{folder}: frame {silent[0]} says no force, as others do: give the machine's record, force_file"
        )
    frames = [frame for frame in series.frames if frame.force is not None]
    numbers = np.array([frame.number for frame in frames], dtype=float)
    force = np.array([[frame.force] for frame in frames])
    way = [[frame.crosshead] for frame in frames]
    way = None if [None] in way else np.array(way)
    named = ("force of each frame",)
    return ForceRecord(path=folder, image=numbers, axes=(PULL,), force=force, displacement=way, channels=named)


def _channel(table: Table, channel: str, key: str = "force_channel") -> int:
    """Column of a name that the configuration gives."""
    full = [name.lower() for name in table.header]
    wanted = channel.strip().lower()
    at = [k for k, names in enumerate(zip(full, table.names, strict=True)) if wanted in names]
    if len(at) != 1:
        raise DicError(
            f"{table.path}:{table.line}: {len(at) or 'no'} columns {channel!r} among {shown(table.header)}: "
            f"set {key} to the whole name of one"
        )
    return at[0]


def _force_columns(table: Table, channel: str | dict[str, str] | None) -> dict[str, int]:
    """Column of the force by axis."""
    if isinstance(channel, dict):
        return {axis: _channel(table, name) for axis, name in sorted(channel.items())}
    if channel is not None:
        return {PULL: _channel(table, channel)}
    if all(table.dialect.force.values()):
        return {axis: _unit_that_is_a_force(table, names) for axis, names in table.dialect.force.items()}
    at = [k for k, unit in enumerate(table.units) if unit in FORCE_UNITS]
    if len(at) == 1:
        return {PULL: at[0]}
    volts = [k for k, unit in enumerate(table.units) if unit in VOLTS]
    if not at and volts:
        return {PULL: volts[0]}
    found = [table.header[k] for k in at]
    raise DicError(
        f"{table.path}:{table.line}: {len(at) or 'no'} columns in N among {shown(found or table.header)}: set "
        "force_channel to one"
    )


def _unit_that_is_a_force(table: Table, names: tuple[str, ...]) -> int:
    """Of columns of one name, that in N before that in V."""
    at = [k for k, name in enumerate(table.names) if name in names]
    forces = [k for k in at if table.units[k] in FORCE_UNITS]
    if len({(table.header[k], table.units[k]) for k in forces}) < len(forces):
        raise DicError(f"{table.path}:{table.line}: two columns {table.header[forces[0]]!r}: rename the other one")
    return (forces or at)[0]


def _scale(table: Table, column: int, known: dict[str, float], wanted: str) -> float:
    """Factor of a column to s or N."""
    unit, line = table.units[column], table.line + (table.dialect.units == "row")
    if unit in VOLTS and known is FORCE_UNITS:
        raise DicError(
            f"{table.path}:{line}: {table.header[column]!r} is in volts, not calibrated: export the force in N"
        )
    if not unit and known is TIME_UNITS and table.dialect.units != "row":
        return 1.0
    if unit not in known:
        what = "the line of units" if table.dialect.units == "row" else "the header"
        raise DicError(
            f"{table.path}:{line}: {what} must give {wanted}, found {unit[:40]!r} for {table.header[column][:80]!r}; "
            f"known are {', '.join(known)}"
        )
    return known[unit]


def _with_a_force(table: Table, columns: list[int]) -> Table:
    """The table without rows whose cells of the force are all empty, as where a logger has several rates.

    Raises:
        DicError: no row has a force.
    """
    rows = [row for row in table.rows if any(row[1][k].strip().lower() not in NOT_A_NUMBER for k in columns)]
    if not rows:
        raise DicError(f"{table.path}:{table.line}: no sample has a force: name another column, force_channel")
    return replace(table, rows=rows)


def _decimal(table: Table, columns: list[int]) -> str:
    cells = ((line, cells[k]) for line, cells in table.rows for k in columns)
    try:
        return decimal_sign(cells)
    except AmbiguousNumbersError as error:
        raise DicError(f"{table.path}:{error.line}: {error}") from None


def _samples(table: Table, columns: list[tuple[int, float]], decimal: str, timed: bool) -> np.ndarray:
    """Numbers of columns (sample, column) times their factors, finite, the first never decreasing if it is time."""
    samples: list[list[float]] = []
    for line, cells in table.rows:
        try:
            samples.append([parse_number(cells[k], decimal) * factor for k, factor in columns])
        except ValueError:
            raise DicError(
                f"{table.path}:{line}: not a sample: {','.join(cells)[:60]!r}: delete lines that hold none"
            ) from None
        if not np.isfinite(samples[-1]).all():
            raise DicError(f"{table.path}:{line}: not finite: {','.join(cells)[:60]!r}")
        if timed and len(samples) > 1 and samples[-1][0] < samples[-2][0]:
            raise DicError(
                f"{table.path}:{line}: time goes back from {samples[-2][0]:g} to {samples[-1][0]:g} s: delete rows "
                "that are of another test, or name a column that goes on, --set time_channel=NAME"
            )
    return np.array(samples)


def _read_in_time(table: Table, values: np.ndarray) -> tuple[Table, np.ndarray]:
    """Rows and their values [s, N], each at its own time, without those that repeat an earlier reading."""
    kept = read_anew(values[:, 1:])
    time = spread_ticks(values[:, 0], values[:, 1:])
    rows = [row for row, keep in zip(table.rows, kept, strict=True) if keep]
    return replace(table, rows=rows), np.column_stack([time, values[:, 1:]])[kept]


def _displacement(table: Table, axes: tuple[str, ...], decimal: str) -> np.ndarray | None:
    """Displacement [mm] by sample and axis; None where a column, its unit or a number of it is not there."""
    names = [table.dialect.ways(axis) for axis in axes]
    columns = [table.find(each) for each in names]
    if None in columns or any(table.units[k] not in LENGTH_UNITS for k in columns):
        return None
    try:
        values = np.array([[parse_number(cells[k], decimal) for k in columns] for _, cells in table.rows])
    except ValueError:
        return None
    return values * np.array([LENGTH_UNITS[table.units[k]] for k in columns]) if np.isfinite(values).all() else None
