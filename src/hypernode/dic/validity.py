"""Which points a program marks as failed, by a column beside their displacements."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from hypernode.dic.dialect import NOT_A_NUMBER
from hypernode.dic.errors import DicError
from hypernode.dic.text import shown

#: Columns of which a value below zero, or none at all, marks a failed point, in lower case: no correlation, residual or
#: number of a state is negative.
_BELOW_ZERO = (
    *("zncc", "ncc", "cost_zncc", "corr", "corrcoef", "correlation", "correlation coefficient", "coefficient"),
    # Not gamma and beta: they are quality for one program, and an angle of strain, of either sign, for others.
    *("sigma", "match", "confidence", "quality", "score", "chi", "chi2", "residual"),
    *("status", "status_flag", "statusflag", "state", "flag", "iteration", "iterations"),
)
#: Of these columns, which are zero at no point that was found.
_CORRELATION = (
    "confidence",
    "quality",
    "score",
    "zncc",
    "ncc",
    "corr",
    "corrcoef",
    "correlation",
    "correlation coefficient",
)
#: Columns of which zero does as well.
_ZERO = ("converged", "convergence_flag", "valid", "is_valid", "isvalid", "validity", "success", "ok", "good")
#: Columns that mark failed points by any number above zero, or a word that says yes.
_FAILS = ("failed", "fail", "invalid", "is_invalid", "outlier", "is_outlier", "bad", "lost", "rejected")
#: Columns whose ones are the sheet for one program, and what is cut away for another.
_ASKED = ("mask", "roi")
#: Words of failed points in such columns.
_FAILED = {"false", "f", "no", "n", "fail", "failed", "invalid", "bad", "lost", "error", "nok", "not converged"}

#: Smallest and largest value of a valid point; None where there is no such bound.
Range = tuple[float | None, float | None]


def known_columns(names: list[str]) -> dict[str, int]:
    """Name -> index of the columns of a header, without units, that are known to mark failed points."""
    return {name: k for k, name in enumerate(names) if name.strip().lower() in _BELOW_ZERO + _ZERO + _FAILS + _ASKED}


def named_columns(path: Path, line: int, names: list[str], valid: Mapping[str, Range]) -> dict[str, int]:
    """The same of the columns that the configuration names.

    Raises:
        DicError: the header has none of a name.
    """
    for name in valid:
        if name not in names:
            raise DicError(f"{path}:{line}: no column {name!r} among {shown(names)}: correct the name in the key valid")
    return {name: names.index(name) for name in valid}


def value_of(cell: str, decimal: str) -> float:
    """The number in a cell of such a column: NaN if it is empty, -1 for a word that says no, 1 for any other word."""
    word = cell.strip().strip('"').lower()
    if word in NOT_A_NUMBER:
        return np.nan
    try:
        return float(word.replace(",", ".") if decimal == "," else word)
    except ValueError:
        return -1.0 if word in _FAILED else 1.0


def question(name: str, values: Float[np.ndarray, " point"], valid: Mapping[str, Range]) -> str:
    """What only its owner knows of a column; empty where nothing is asked."""
    yes = int((values > 0.0).sum())
    if name in valid or name.strip().lower() not in _ASKED or yes in (0, len(values)):
        return ""
    return (
        f"the column {name!r} is above zero at {yes} of {len(values)} points: are these the points of the sheet, --set "
        f"'valid={{{name}: [1, null]}}', or those that are cut away, --set 'valid={{{name}: [null, 0]}}'?"
    )


def failed(name: str, values: Float[np.ndarray, " point"], valid: Mapping[str, Range]) -> Bool[np.ndarray, " point"]:
    """Which points a column marks as failed.

    A column that the configuration does not name and that would fail all points says nothing of any.
    """
    if name in valid:
        low, high = (
            default if end is None else end for end, default in zip(valid[name], (-np.inf, np.inf), strict=True)
        )
        return ~((values >= low) & (values <= high))
    name = name.strip().lower()
    if name in _ASKED:
        return np.zeros(len(values), dtype=bool)
    lost = ~(values > 0.0) if name in _ZERO else values > 0.0 if name in _FAILS else ~(values >= 0.0)
    # A frame that is compared with itself has no residual anywhere.
    if name in _CORRELATION and (values == 0.0).mean() < 0.5:
        lost |= values == 0.0
    return np.zeros(len(values), dtype=bool) if lost.all() else lost
