"""Tables of settings stay readable however many there are; those of costs hold the records' numbers."""

import json

import pytest

from hypernode.tables.build import build_table
from hypernode.tables.writing import csv_text, latex_text, markdown_text
from tests.tables.files import rows_of


def settings(entries):
    return build_table([], {"kind": "settings", "entries": entries})


def test_moduli_and_angles_have_their_units():
    entries = {"soft": {"model": "neo_hookean", "mu": 1.0}, "stiff": {"model": "goh", "k2": 0.5, "fibre_angle": 30.0}}
    assert rows_of(markdown_text(settings(entries))) == [
        ["name", "model", "mu [Pa or MPa]", "k2", r"fibre\_angle [degree]"],
        ["soft", r"neo\_hookean", "1.0", "-", "-"],
        ["stiff", "goh", "-", "0.5", "30.0"],
    ]


def test_of_too_many_settings_only_differences_are_shown_and_all_are_in_the_csv():
    first = {"seed": 1, "node": {"hidden": [4, 4], "steps": 2}, **{f"key{k}": k for k in range(20)}}
    table = settings({"a": first, "b": first | {"seed": 2}, "c": {**first, "seed": 2, "key7": 0, "node": None}})
    head, *rows = rows_of(markdown_text(table))
    assert head == ["name", "like", "but"]
    assert rows[0][2].startswith("seed = 1; node.hidden = 4, 4; node.steps = 2; key0 = 0;")
    assert rows[1] == ["b", "a", "seed = 2"]
    assert rows[2] == ["c", "b", "key7 = 0; without node"]
    assert csv_text(table).splitlines()[2].startswith('b,2,"4, 4",2,0,1,2,3,')


def test_costs_are_those_of_the_records(tmp_path):
    records = tmp_path / "benchmarks/disc"
    (records / "m").mkdir(parents=True)
    (records / "forward.jsonl").write_text(json.dumps({"s": 3.456789, "max_rss": 389.123}) + "\n")
    (records / "m/training.jsonl").write_text(json.dumps({"s": 0.12, "max_rss": "NA"}) + "\n")
    files = [str(records / name) for name in ("forward.jsonl", "m/training.jsonl")]
    table = build_table(files, {"kind": "timing"})
    assert csv_text(table).splitlines()[1:] == ["disc,(all),forward,3.456789,389.123", "disc,m,training,0.12,"]
    assert rows_of(markdown_text(table))[1:] == [
        ["disc", "(all)", "forward", "3.46", "389"],
        ["disc", "m", "training", "0.120", "-"],
    ]


@pytest.mark.parametrize(("text", "latex"), [("a_b", r"a\_b"), ("50 %", r"50 \%"), ("x & y", r"x \& y"), ("<", "$<$")])
def test_signs_that_latex_reads_are_escaped(text, latex):
    assert f"n & {latex} " in latex_text(settings({"n": {"key": text}}))
