"""Force records of testing machines."""

import csv
from pathlib import Path

import numpy as np
from jaxtyping import Float

from hypernode.dic.errors import DicError


def read_force_record(path: Path) -> tuple[Float[np.ndarray, " sample"], Float[np.ndarray, " sample"]]:
    """Time [s] and force [N] of a testing machine's comma-separated record.

    The first line names the columns Time and Force, the second gives their units.

    Raises:
        DicError: the file, its units or a line cannot be used, or time does not increase.
    """
    try:
        with open(path, newline="", encoding="utf-8-sig") as handle:
            rows = list(csv.reader(handle))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise DicError(f"{path}: cannot be read: {error}") from None
    if len(rows) < 3:
        raise DicError(f"{path}: needs a header, a line of units and at least one sample")
    names = [name.strip().lower() for name in rows[0]]
    for wanted in ("time", "force"):
        if wanted not in names:
            raise DicError(f"{path}:1: no column '{wanted.title()}' among {rows[0]}")
    at_time, at_force = names.index("time"), names.index("force")
    units = [unit.strip().strip("()").lower() for unit in rows[1]]
    if len(units) != len(names):
        raise DicError(f"{path}:2: {len(units)} units for {len(names)} columns")
    scale = {"n": 1.0, "kn": 1e3, "mn": 1e-3}.get(units[at_force])
    if units[at_time] not in ("s", "sec") or scale is None:
        raise DicError(f"{path}:2: the line of units must give time in (s) and force in (N), found {rows[1]}")
    samples = []
    for number, row in enumerate(rows[2:], start=3):
        if not row:
            continue
        try:
            samples.append((float(row[at_time]), float(row[at_force])))
        except (ValueError, IndexError):
            raise DicError(f"{path}:{number}: not a sample: {','.join(row)[:60]!r}") from None
        if len(samples) > 1 and samples[-1][0] < samples[-2][0]:
            raise DicError(f"{path}:{number}: time goes back from {samples[-2][0]:g} to {samples[-1][0]:g} s")
        if not np.isfinite(samples[-1]).all():
            raise DicError(f"{path}:{number}: not finite")
    time, force = np.array(samples).T
    return time, scale * force
