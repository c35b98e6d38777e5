"""Decimal signs and thousands: which of comma and point is which, told from a whole file or refused."""

import re
from collections.abc import Iterable

#: Letters of a number that a message shows.
_SHOWN = 40
_NUMBER = re.compile(r"^[+-]?(?P<digits>[\d.,]*\d[\d.,]*)(?:[eE][+-]?\d+)?$")
_GROUPED = re.compile(r"^[+-]?[1-9]\d{0,2}(?P<sign>[.,])\d{3}(?:(?P=sign)\d{3})*(?:[.,]\d*)?(?:[eE][+-]?\d+)?$")
#: Thousands apart by a blank, a narrow one, or an apostrophe: no program writes decimals so.
_APART = re.compile(r"^[+-]?[1-9]\d{0,2}(?P<sign>[ \xa0\u202f'\u2019])\d{3}(?:(?P=sign)\d{3})*(?:[.,]\d*)?$")


class AmbiguousNumbersError(ValueError):
    """Numbers of a file that can be read in two ways; ``line`` is where."""

    def __init__(self, line: int, text: str):
        super().__init__(text)
        self.line = line


def _together(text: str) -> str:
    """A number without blanks around it and without blanks or apostrophes between its thousands."""
    text = text.strip()
    match = _APART.match(text)
    return text.replace(match["sign"], "") if match else text


def _decimal_of(text: str) -> str | None:
    """The decimal sign that a number proves; None where it has no sign, "" where its one sign may be either."""
    match = _NUMBER.match(text)
    signs = [c for c in match["digits"] if c in ",."] if match else []
    if not signs:
        return None
    last = signs[-1]
    other = "." if last == "," else ","
    if len(set(signs)) == 2:
        return last
    if len(signs) > 1:
        return other
    whole, rest = match["digits"].split(last)
    could_be_thousands = len(rest) == 3 and 1 <= len(whole) <= 3 and not whole.startswith("0")
    return "" if could_be_thousands else last


def decimal_sign(cells: Iterable[tuple[int, str]]) -> str:
    """The decimal sign of a file, from the (line, text) of its numbers.

    "0,5" and "1.234,5" prove a comma, "0.5" and "1,234.5" a point. Points alone are decimal, as everywhere in exports.

    Raises:
        AmbiguousNumbersError: both are proved, or the file has commas that may be either.
    """
    proved, doubtful = {}, None
    for line, text in cells:
        text = _together(text)
        sign = _decimal_of(text)
        if sign:
            proved.setdefault(sign, (line, text[:_SHOWN]))
        elif sign == "" and "," in text:
            doubtful = doubtful or (line, text[:_SHOWN])
    if len(proved) == 2:
        (first, comma), (line, point) = proved[","], proved["."]
        raise AmbiguousNumbersError(
            line,
            f"{point!r} has a decimal point and {comma!r} in line {first} a decimal comma: export it with one of them",
        )
    if proved:
        return next(iter(proved))
    if doubtful:
        raise AmbiguousNumbersError(
            doubtful[0],
            f"{doubtful[1]!r} may have a decimal comma or thousands: export it with decimal points and no thousands",
        )
    return "."


def parse_number(text: str, decimal: str) -> float:
    """The number that a cell holds.

    Raises:
        ValueError: it holds none.
    """
    text = _together(text)
    thousands = "." if decimal == "," else ","
    if "_" in text:
        raise ValueError(f"{text!r} is not a number")
    if thousands in text:
        if not _GROUPED.match(text):
            raise ValueError(f"{text!r} is not a number")
        text = text.replace(thousands, "")
    return float(text.replace(decimal, "."))
