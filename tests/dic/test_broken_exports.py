"""A broken displacement file of any dialect is refused with its name, its line and what is wrong with it."""

import numpy as np
import pytest

from hypernode.dic.dialects import BY_NAME
from hypernode.dic.reading import read_series
from tests.dic.exports import FRAMES, MM, write
from tests.dic.refusals import refused


class Export:
    """The last frame of a dialect as lines, to be broken and written again."""

    def __init__(self, folder, case):
        self.case, self.path = case, write(folder, case)
        self.dialect = BY_NAME[case.split(",")[0]]
        self.encoding = "cp1252" if case == "davis_stereo" else "utf-8"
        _, header, _, self.delimiter, self.decimal, _, _ = FRAMES[case]
        self.head = len(header.split("\n"))
        self.lines = self.path.read_bytes().decode(self.encoding).split("\r\n")[:-1]
        names = [name.strip(' "#\ufeff') for name in self.lines[self.head - 1].split(self.delimiter)]
        self.names = [name.split(" [")[0] for name in names]

    def column(self, role):
        """Place of the cell of a role in every row."""
        if self.case == "davis8":
            return "xyuv".index(role)
        return next(self.names.index(name) for name in getattr(self.dialect, role) if name in self.names)

    def cells(self, change, rows=slice(None), header=False):
        """A change to the cells of rows, and of the header."""
        lines = list(range(self.head, len(self.lines)))[rows] + ([self.head - 1] if header else [])
        for k in lines:
            self.lines[k] = self.delimiter.join(change(self.lines[k].split(self.delimiter)))

    def save(self, content=None):
        text = "\r\n".join([*self.lines, ""])
        self.path.write_bytes(text.encode(self.encoding) if content is None else content)


def with_cell(at, value):
    def change(cells):
        return [*cells[:at], value(cells[at]) if callable(value) else value, *cells[at + 1 :]]

    return change


def shifted(export, by=0.0, scale=1.0):
    """A coordinate in another unit, or moved by a share of a step."""
    step = FRAMES[export.case][0]

    def change(cell):
        return f"{scale * float(cell.replace(export.decimal, '.')) + by * step:.15g}".replace(".", export.decimal)

    return change


def cut_within_a_line(export):
    export.save("\r\n".join(export.lines)[: -(len(export.lines[-1]) // 2 + 4)].encode(export.encoding))


def cut_within_a_number(export):
    export.save("\r\n".join(export.lines)[:-1].encode(export.encoding))


def a_word_for_a_number(export):
    export.cells(with_cell(export.column("x"), "#REF!"), slice(3, 4))
    export.save()


def a_word_for_a_displacement(export):
    export.cells(with_cell(export.column("v"), "1.2.3".replace(".", export.decimal)), slice(5, 6))
    export.save()


def a_point_twice(export):
    export.lines[-1] = export.lines[export.head]
    export.save()


def a_column_less(export):
    at = export.column("v")
    export.cells(lambda cells: cells[:at] + cells[at + 1 :], header=export.case != "davis8")
    export.save()


def a_column_twice(export):
    at = export.column("u")
    export.cells(lambda cells: [*cells[: at + 1], *cells[at:]], header=export.case != "davis8")
    export.save()


def another_delimiter(export):
    export.lines = [line.replace(export.delimiter, "|") for line in export.lines]
    export.save()


def the_other_decimal_sign(export):
    export.cells(with_cell(export.column("u"), lambda cell: cell.replace(export.decimal, ".,"[export.decimal == "."])))
    export.save()


def in_units(export, position, displacement):
    """Other units in the header, which may have none."""
    if export.case == "davis8":
        export.lines[0] = f'#DaVis 8.1.2 2D-vector 8 6 5 "" "{position}" "" "{position}" "d" "{displacement}"'
        return

    def renamed(cell):
        name = cell.strip(' "#\ufeff').split(" [")[0]
        for roles, unit in (("xyz", position), ("uvw", displacement)):
            if any(name in getattr(export.dialect, role) for role in roles):
                return cell.split(name)[0] + f"{name} [{unit}]" + '"' * cell.endswith('"')
        return cell

    export.cells(lambda cells: list(map(renamed, cells)), slice(0, 0), header=True)


def feet(export):
    in_units(export, "foot", "foot")
    export.save()


def positions_in_mm_and_displacements_in_pixels(export):
    in_units(export, "mm", "px")
    export.save()


def units_of_another_frame(export):
    other = "px" if FRAMES[export.case][0] == MM else "mm"
    in_units(export, other, other)
    export.save()


def positions_in_metres(export):
    for role in "xy":
        export.cells(with_cell(export.column(role), shifted(export, scale=1e-3)))
    export.save()


def empty(export):
    export.save(b"")


def only_a_header(export):
    export.lines = export.lines[: export.head]
    export.save()


def zero_bytes(export):
    export.save(bytes(range(256)) * 8)


def noise(export):
    export.save(np.random.default_rng(4).integers(1, 256, 3000, dtype=np.uint8).tobytes())


def utf_16_without_its_mark(export):
    export.save("\r\n".join(export.lines).lstrip("\ufeff").encode("utf-16-le"))


def half_a_step_aside(export):
    export.cells(with_cell(export.column("x"), shifted(export, 0.4)))
    export.save()


def two_exports_in_one_file(export):
    export.lines = [*export.lines, *export.lines[export.head - 1 :]]
    export.save()


#: Fault -> what is said of it, and whether a line is named.
FAULTS = {
    cut_within_a_line: (r"\d+ fields, the header has|the last line has no end|points, the first line promises", True),
    cut_within_a_number: (r"the file is cut off|not a number|\d+ fields, the header has", True),
    a_word_for_a_number: ("not a number in .*#REF!", True),
    a_word_for_a_displacement: ("not a number in .*1[.,]2[.,]3", True),
    a_point_twice: ("is there twice", True),
    a_column_less: ("no column '|3 fields, the header has 4", True),
    a_column_twice: ("two columns '|5 fields, the header has 4", True),
    another_delimiter: ("the header must be separated by|1 fields", True),
    the_other_decimal_sign: ("decimal comma|decimal point among|fields, the header has", True),
    feet: ("no column '.*foot|lengths in 'foot'", None),
    positions_in_mm_and_displacements_in_pixels: (r"no column '.*\[(mm|px)\]|in different units \(mm, px\)", None),
    units_of_another_frame: (
        r"no column '.*\[(mm|px)\]|other columns or units \((mm|pixel)\) than|different units",
        None,
    ),
    positions_in_metres: ("is not on the grid of frame|is there twice: are positions in another unit", True),
    empty: ("the file is empty", True),
    only_a_header: ("no points", True),
    zero_bytes: ("cannot be read as text: it holds zero bytes", False),
    noise: ("not a file of", True),
    utf_16_without_its_mark: ("cannot be read as text: it holds zero bytes", False),
    half_a_step_aside: ("is not on the grid of frame", True),
    two_exports_in_one_file: ("not a number|fields, the header has|points, the first line promises", True),
}


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.__name__)
@pytest.mark.parametrize("case", FRAMES)
def test_a_broken_frame_is_refused_with_its_reason(tmp_path, case, fault):
    export = Export(tmp_path, case)
    fault(export)
    words, line = FAULTS[fault]
    with refused(export.path, words, line):
        read_series(tmp_path)


@pytest.mark.parametrize("case", FRAMES)
def test_a_frame_in_utf_16_with_its_mark_is_read(tmp_path, case):
    export = Export(tmp_path, case)
    series = read_series(tmp_path)
    export.save("\r\n".join([*export.lines, ""]).lstrip("\ufeff").encode("utf-16"))
    for ours, theirs in zip(read_series(tmp_path).frames, series.frames, strict=True):
        np.testing.assert_array_equal(ours.displacement, theirs.displacement)
