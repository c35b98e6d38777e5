"""However its cells are written, a table is read to the same bits."""

import numpy as np
import pytest

from hypernode.dic.dialects import declared
from hypernode.dic.errors import DicError
from hypernode.dic.table import read_table

COLUMNS = {"x": "x", "y": "y", "u": "u", "v": "v", "unit": "mm", "deformed": False}
HEADER = ["x", "y", "note", "u", "v"]


def read(tmp_path, rows, delimiter=",", decimal="."):
    (tmp_path / "f.csv").write_text("\n".join(delimiter.join(row) for row in [HEADER, *rows]) + "\n")
    cells, line, _, _ = read_table(tmp_path / "f.csv", declared(**COLUMNS, delimiter=delimiter, decimal=decimal))
    assert line.tolist() == list(range(2, len(rows) + 2))
    return np.stack([cells[role] for role in "xyuv"], axis=1)


VALUES = np.random.default_rng(2).normal(size=(50, 4)) * 10.0 ** np.random.default_rng(3).integers(-300, 300, (50, 4))
TEXTS = [[repr(v) for v in row] for row in VALUES.tolist()]
WRITTEN = {
    "plain": (",", ".", lambda cell: cell),
    "quoted": (",", ".", '"{}"'.format),
    "with blanks around": (",", ".", "  {} ".format),
    "blanks between": (" ", ".", lambda cell: cell),
    "tabs and decimal commas": ("\t", ",", lambda cell: cell.replace(".", ",")),
    "decimal commas in quotes": (",", ",", lambda cell: f'"{cell.replace(".", ",")}"'),
}


@pytest.mark.parametrize("name", WRITTEN)
@pytest.mark.parametrize("note", ["0", "ok"])
def test_every_way_to_write_a_number_gives_its_bits(tmp_path, name, note):
    delimiter, decimal, write = WRITTEN[name]
    rows = [[*map(write, row[:2]), note, *map(write, row[2:])] for row in TEXTS]
    np.testing.assert_array_equal(read(tmp_path, rows, delimiter, decimal), VALUES)


@pytest.mark.parametrize("lost", ["", "nan", "NaN", " ", "n. def."])
@pytest.mark.parametrize("note", ["", "0"])
def test_lost_points_are_lost_and_no_others(tmp_path, lost, note):
    rows = [[*row[:2], note, *row[2:]] for row in TEXTS]
    expected = VALUES.copy()
    for at in (0, 20, 21, 49):
        rows[at][3:] = [lost, lost]
        expected[at, 2:] = np.nan
    np.testing.assert_array_equal(read(tmp_path, rows), expected)


@pytest.mark.parametrize(
    ("cell", "decimal", "message"),
    [
        ("1_0", ".", "not a number"),
        ("0x10", ".", "not a number"),
        ("1,5", ".", "decimal comma"),
        ("1.234,5", ",", "decimal point among decimal commas"),
        ("1.5", ",", "decimal point among decimal commas"),
    ],
)
def test_what_another_program_would_read_otherwise_is_no_number(tmp_path, cell, decimal, message):
    rows = [["1", "2", "0", "3", "4"], ["1", "2", "0", "3", cell]]
    with pytest.raises(DicError, match=rf"f\.csv:3: .*{message}"):
        read(tmp_path, rows, ";", decimal)
