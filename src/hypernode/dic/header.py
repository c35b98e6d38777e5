"""The header of a displacement file: which dialect it shows, where its table begins, what is wrong with it."""

import csv
import re
from dataclasses import KW_ONLY, dataclass
from pathlib import Path

from hypernode.dic.dialect import Dialect
from hypernode.dic.errors import DicError
from hypernode.dic.text import shown

#: Lines in which a header is looked for, and bytes of a file that hold them.
HEAD_LINES, HEAD_BYTES = 300, 1 << 17
#: Units of lengths, by the unit of a series and the factor to it.
LENGTHS = {
    "pixel": ("pixel", 1.0), "pixels": ("pixel", 1.0), "px": ("pixel", 1.0),
    "mm": ("mm", 1.0), "m": ("mm", 1e3), "cm": ("mm", 10.0), "um": ("mm", 1e-3), "µm": ("mm", 1e-3),
    "μm": ("mm", 1e-3), "micron": ("mm", 1e-3), "microns": ("mm", 1e-3), "in": ("mm", 25.4), "inch": ("mm", 25.4),
}  # fmt: skip
_SIGN = re.compile(r"[.,](?=\d)")
_DAVIS8 = re.compile(r'^#DaVis \S+ 2D-vector \d+ (\d+) (\d+) "" "(\w+)" "" "(\w+)" "([^"]*)" "([^"]*)"')


@dataclass(frozen=True)
class Layout:
    """Where a file's table begins, how its cells are told apart, and how many rows it says that it has."""

    names: list[str]
    delimiter: str
    decimal: str
    header: int
    _: KW_ONLY
    rows: int | None = None


def cells_of(line: str, delimiter: str) -> list[str]:
    """The cells of a line, without quotes and blanks around them; a blank as delimiter is any run of blanks."""
    if delimiter == " ":
        return with_units(line.split())
    if '"' in line:
        try:
            return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))]
        except (csv.Error, StopIteration):
            return []
    return [cell.strip() for cell in line.split(delimiter)]


def with_units(cells: list[str]) -> list[str]:
    """Cells that stood between blanks, of which a unit in brackets belongs to the name before it.

    In a line of units alone, each is a cell of its own.
    """
    merged: list[str] = []
    for cell in cells:
        named = bool(merged) and merged[-1][:1] not in ("[", "(") and any(map(str.isalnum, merged[-1]))
        if named and cell[:1] in ("[", "(") and cell[-1:] in ("]", ")"):
            merged[-1] += f" {cell}"
        else:
            merged.append(cell)
    return merged


def bare(name: str) -> str:
    """A column's name without its unit."""
    return re.sub(r"\s*\[[^\]]*\]\s*$", "", name)


def _names(line: str, delimiter: str) -> list[str]:
    return cells_of(line.lstrip("# "), delimiter)


def layout_of(lines: list[str], dialect: Dialect) -> Layout | None:
    """Where the table of a dialect begins among the lines of a file; ``None`` where the file is of another."""
    if dialect.content == "davis8":
        match = _DAVIS8.match(lines[0]) if lines else None
        if match is None:
            return None
        unit, decimal = match[3], "," if any("," in line for line in lines[1:]) else "."
        return Layout(
            [f"x [{unit}]", f"y [{match[4]}]", f"u [{match[6]}]", f"v [{match[6]}]"],
            "\t",
            decimal,
            0,
            rows=int(match[1]) * int(match[2]),
        )
    if not dialect.recognised:
        return None
    if all(name.isascii() and name.isdigit() for name in dialect.recognised):
        return _without_names(lines, dialect)
    words = {word for name in dialect.recognised for word in name.split()}
    for index, line in enumerate(lines[:HEAD_LINES]):
        # Nearly all lines lack a word of nearly all dialects, and need not be taken apart.
        if not all(word in line for word in words):
            continue
        for delimiter in dict.fromkeys(delimiter for delimiter, _ in dialect.layouts):
            names = _names(line, delimiter)
            seen = {*names, *map(bare, names)}
            if len(names) < 4 or not set(dialect.recognised) <= seen or seen & set(dialect.absent):
                continue
            decimals = {decimal for sign, decimal in dialect.layouts if sign == delimiter}
            columns = [k for k, name in enumerate(names) if {name, bare(name)} & _read(dialect)]
            comma = len(decimals) > 1 and _has_decimal_comma(lines[index + 1 :], delimiter, columns)
            decimal = "," if comma or decimals == {","} else "."
            units = _units_below(lines[index + 1 : index + 2], delimiter, len(names))
            if units is None or any(bare(name) != name for name in names):
                return Layout(names, delimiter, decimal, index)
            return Layout(
                [f"{name} [{unit}]" for name, unit in zip(names, units, strict=True)], delimiter, decimal, index + 1
            )
    return None


def _read(dialect: Dialect) -> set[str]:
    """Names of the columns that hold positions and displacements."""
    return {*dialect.x, *dialect.y, *dialect.u, *dialect.v}


def _has_decimal_comma(lines: list[str], delimiter: str, columns: list[int]) -> bool:
    """Whether the first number of these columns that has a sign has a comma: clocks and numbers of points may have one.

    Of several signs in a number the last is that of decimals.
    """
    for line in lines:
        # Whole numbers say nothing of the sign.
        if "," in line or "." in line:
            cells = cells_of(line, delimiter)
            signs = [_SIGN.findall(cells[k]) for k in columns if k < len(cells) and cells[k][-1:].isdigit()]
            if any(signs):
                return next(filter(None, signs))[-1] == ","
    return False


def _units_below(lines: list[str], delimiter: str, width: int) -> list[str] | None:
    """The cells of a line of units below the names; None where there is none."""
    cells = [cell.strip("[]() ") for line in lines for cell in _names(line, delimiter)]
    lengths = sum(cell.lower() in LENGTHS for cell in cells)
    return cells if len(cells) == width and lengths >= len("xyuv") and not any(map(is_number, cells)) else None


def _without_names(lines: list[str], dialect: Dialect) -> Layout | None:
    """Where a table of numbers begins that has no header: its columns have the names 1, 2, 3 and so on."""
    wanted = [int(name) - 1 for name in dialect.recognised]
    for index, line in enumerate(lines[:HEAD_LINES]):
        for delimiter, decimal in dialect.layouts:
            cells = [cell.replace(",", ".") if decimal == "," else cell for cell in cells_of(line, delimiter)]
            if min(wanted) >= 0 and max(wanted) < len(cells) and all(is_number(cells[k]) for k in wanted):
                comma = (delimiter, ",") in dialect.layouts and _has_decimal_comma(lines[index:], delimiter, wanted)
                return Layout([str(k + 1) for k in range(len(cells))], delimiter, "," if comma else decimal, index - 1)
    return None


def is_number(cell: str) -> bool:
    """Whether a cell holds a number with a decimal point."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def shows(lines: list[str], dialect: Dialect) -> bool:
    """Whether a file is of a dialect: its header has the columns, and those of a dialect in pixels are not in mm.

    Columns of usual names in mm are of any program, and y of a picture points the other way.
    """
    layout = layout_of(lines, dialect)
    if layout is None or dialect.unit != "pixel":
        return layout is not None
    return not any(bare(name) in dialect.x and name.lower().endswith("mm]") for name in layout.names)


def refusal(path: Path, lines: list[str], dialect: Dialect) -> DicError:
    """What is wrong with the header of a file that is not of its series' dialect."""
    if not lines:
        return DicError(f"{path}:1: the file is empty: export it again, or delete it")
    if not dialect.recognised:
        return DicError(f"{path}:1: not a file of {dialect.software}, found {lines[0][:60]!r}")
    at, names = _most_like_a_header(lines, dialect)
    where = f"{path}:{at + 1}"
    if not names:
        signs = " or ".join(repr(sign) for sign in dict.fromkeys(delimiter for delimiter, _ in dialect.layouts))
        return DicError(
            f"{where}: not a file of {dialect.software}: the header must be separated by {signs} and have the columns "
            f"{shown(dialect.recognised)}, found {lines[at][:60]!r}"
        )
    said = [f"no column {name!r}" for name in dialect.recognised if name not in {*names, *map(bare, names)}]
    said += [f"a column {name!r}" for name in dialect.absent if name in names] + ["fewer than four columns"]
    return DicError(
        f"{where}: {said[0]} among {shown(names)}: export positions and displacements as {dialect.software} does, or "
        "say another format"
    )


def _most_like_a_header(lines: list[str], dialect: Dialect) -> tuple[int, list[str]]:
    """(index of the line with most of a dialect's columns, its columns); no columns where it has them as text only."""
    known = {*dialect.recognised, *map(bare, dialect.recognised)}
    best = (-1, -1, 0, [])
    for at, line in enumerate(lines[:HEAD_LINES]):
        for delimiter, _ in dialect.layouts:
            names = _names(line, delimiter)
            columns, words = len(known & set(map(bare, names))), sum(name in line for name in known)
            if (columns, words) > best[:2]:
                best = (columns, words, at, names if columns else [])
    return best[2:]
