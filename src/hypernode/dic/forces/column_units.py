"""The name and the unit of a column of a record, in the ways in which programs write them in one cell."""

import functools
import re

from hypernode.dic.forces.dialects import FORCE_UNITS, LENGTH_UNITS, STRESS_UNITS, TIME_UNITS, VOLTS

_BRACKETS = re.compile(r"^(?P<name>.*?)\s*[\[(](?P<unit>[^\[\]()]*)[\])]$")
_SUFFIX = re.compile(r"^(?P<name>.*)_(?P<unit>[^_]+)$")
#: A unit after a sign or a blank, as in Force / N, Force, N, F in N and Force N.
_SIGN = re.compile(r"^(?P<name>.+?)\s*(?:/|,|\s+in\s|\s)\s*(?P<unit>[^\s/,]+)$")
_UNITS = {*TIME_UNITS, *FORCE_UNITS, *LENGTH_UNITS, *STRESS_UNITS, *VOLTS}


# Every dialect asks for the same cells.
@functools.lru_cache(maxsize=4096)
def name_and_unit(cell: str, units: str) -> tuple[str, str]:
    """(name in lower case, unit, empty where there is none) of a column.

    Args:
        cell: of the header.
        units: how the dialect writes them, as in :class:`ForceDialect`.
    """
    pattern = {"brackets": _BRACKETS, "suffix": _SUFFIX}.get(units)
    match = pattern.match(cell.strip()) if pattern else None
    if units == "brackets" and match is None and (after := _SIGN.match(cell.strip())) and after["unit"] in _UNITS:
        match = after
    return (match["name"].strip().lower(), match["unit"].strip()) if match else (cell.strip().lower(), "")
