"""Which picture a sample of a record belongs to, where a column names or counts them."""

import re

import numpy as np

from hypernode.dic.errors import DicError
from hypernode.dic.forces.dialects import PICTURE_NAMES
from hypernode.dic.forces.numbers import parse_number
from hypernode.dic.forces.table import Table

#: The number of a picture in its file's name: Image_0007_0.tiff is the seventh picture of camera 0.
_PICTURE = re.compile(r"(?P<number>\d+)(?:_\d)?\.[A-Za-z]+$")


def picture_column(table: Table) -> int | None:
    """The column that names pictures: the dialect's, or one of a usual name that says more than one number."""
    at = table.find(table.dialect.image)
    if at is not None or table.dialect.image:
        return at
    at = table.find(PICTURE_NAMES)
    return at if at is not None and len({cells[at].strip() for _, cells in table.rows} - {""}) > 1 else None


def pictures_of(table: Table, column: int, needed: bool) -> np.ndarray | None:
    """Number of every sample's picture; None where a column of a usual name says something else beside a time."""
    try:
        numbers = _pictures(table, column, needed)
    except DicError:
        if table.dialect.image or needed:
            raise
        return None
    begins = np.append(True, np.diff(numbers) != 0.0)
    if table.dialect.image or np.isnan(numbers).any() or begins.sum() > 0.5 * len(numbers):
        return numbers
    # A counter that stands until the next picture: the picture is of the sample with which it begins.
    return np.where(begins, numbers, np.nan)


def _pictures(table: Table, column: int, needed: bool) -> np.ndarray:
    """Number of every sample's picture; NaN where it has none, which is an error where nothing else tells its time."""
    numbers, last = [], -np.inf
    for line, cells in table.rows:
        cell = cells[column].strip()
        match = _PICTURE.search(cell)
        try:
            number = parse_number(match["number"] if match else cell.replace(",", ".") or "nan", ".")
        except ValueError:
            number = np.inf
        if np.isinf(number) or not (np.isnan(number) or number.is_integer()):
            raise DicError(f"{table.path}:{line}: {cell[:60]!r} names no picture")
        if needed and np.isnan(number):
            raise DicError(f"{table.path}:{line}: neither a time nor the number of a picture")
        if number < last:
            raise DicError(f"{table.path}:{line}: pictures go back from {last:g} to {number:g}")
        last = last if np.isnan(number) else number
        numbers.append(number)
    return np.array(numbers)
