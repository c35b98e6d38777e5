"""What columns beside the force of a record tell of it: a stress, or the volts that were not calibrated."""

import numpy as np

from hypernode.dic.errors import DicError
from hypernode.dic.forces.dialects import STRESS_UNITS, VOLTS
from hypernode.dic.forces.numbers import parse_number
from hypernode.dic.forces.table import Table


def section_of(table: Table, force: np.ndarray, decimal: str) -> float | None:
    """Force [N] over the stress of a column beside it [MPa], where they are in one proportion."""
    for at in (k for k, unit in enumerate(table.units) if unit in STRESS_UNITS):
        try:
            stress = STRESS_UNITS[table.units[at]] * np.array([parse_number(row[at], decimal) for _, row in table.rows])
        except ValueError:
            continue
        large = np.abs(stress) > 0.3 * np.abs(stress).max(initial=0.0)
        ratio = force[large] / stress[large]
        if large.any() and np.median(ratio) > 0.0 and np.ptp(ratio) <= 0.1 * np.median(ratio):
            return float(np.median(ratio))
    return None


def refuse_volts(table: Table, forces: dict[str, int], values: np.ndarray, decimal: str) -> None:
    """Refuse a column that says N and repeats the volts of a column beside it."""
    for volts in (k for k, unit in enumerate(table.units) if unit in VOLTS):
        try:
            raw = np.array([parse_number(cells[volts], decimal) for _, cells in table.rows])
        except ValueError:
            continue
        for column, at in enumerate(forces.values()):
            if np.array_equal(raw, values[:, column]) and np.ptp(raw) > 0:
                raise DicError(
                    f"{table.path}:{table.line}: {table.header[at]!r} repeats the volts of {table.header[volts]!r}: "
                    "export the calibrated force"
                )
