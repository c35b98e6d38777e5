"""Numbers are printed in one style and every column says its unit."""

import re

import pytest

from hypernode.tables.columns import COLUMNS, DEFAULT, significant
from hypernode.tables.limits import MOST_COLUMNS

ALL = [(kind, name) for kind, columns in COLUMNS.items() for name in columns]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1234.5, "1234"),
        (99.96, "100"),
        (9.996, "10.0"),
        (7.0, "7.00"),
        (0.123456, "0.123"),
        (0.00012345, "0.000123"),
        (3e-9, "< 0.0001"),
        (-0.5, "-0.500"),
        (float("nan"), "no number"),
        (float("-inf"), "no number"),
    ],
)
def test_a_number_has_three_significant_digits_and_no_exponent(value, text):
    assert significant(value) == text


@pytest.mark.parametrize(("kind", "name"), ALL)
def test_a_column_prints_in_the_style_of_its_kind_of_number(kind, name):
    column = COLUMNS[kind][name]
    wanted = {"percent": r"12\.3", "share": r"0\.123", "number": r"0\.123", "count": "0", "text": r"0\.12345"}
    assert re.fullmatch(wanted[column.style], column.shown(0.12345))
    assert column.shown(None) == column.shown(float("nan")) == "-"


@pytest.mark.parametrize(("kind", "name"), ALL)
def test_a_head_carries_the_unit_as_shown_and_as_stored(kind, name):
    column = COLUMNS[kind][name]
    if column.style == "percent":
        assert (column.header(name), column.header(name, stored=True)) == (f"{name} [%]", f"{name} [-]")
    elif column.style in ("share", "number"):
        assert column.header(name) == column.header(name, stored=True) == f"{name} [{column.unit}]"


@pytest.mark.parametrize("kind", DEFAULT)
def test_what_is_shown_by_default_fits_beside_its_labels(kind):
    assert set(DEFAULT[kind]) <= set(COLUMNS[kind])
    assert len(DEFAULT[kind]) + len(("case", "method")) <= MOST_COLUMNS


def test_a_name_can_be_told_from_two_in_a_list_of_names():
    assert not [name for _, name in ALL if ", " in name]
