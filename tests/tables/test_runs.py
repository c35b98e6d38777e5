"""What a table of runs promises: nothing rounded in the CSV, the best marked, the verdict on every run."""

import io

import pandas as pd
import pytest

from hypernode.config.loading import ConfigError, check_config
from hypernode.tables.build import build_table
from hypernode.tables.columns import COLUMNS
from hypernode.tables.writing import csv_text, latex_text, markdown_text
from tests.tables.files import evaluation, rows_of, summary

SETTINGS = {"kind": "runs", "columns": ["stress error", "Dice", "spread"], "groups": {}}


def build(paths, **settings):
    return build_table(paths, SETTINGS | settings)


@pytest.fixture
def three(tmp_path):
    """Two methods of one case, of which the second is better, and one of another."""
    return [
        evaluation(tmp_path, "disc", "first", summary(0.123456789012345678, spread=0.5, parameters=490)),
        evaluation(tmp_path, "disc", "second", summary(0.05, spread=0.25)),
        evaluation(tmp_path, "ring", "first", summary(0.5)),
    ]


def test_the_csv_holds_every_column_and_every_digit(three):
    frame = pd.read_csv(io.StringIO(csv_text(build(three))), float_precision="round_trip")
    assert len(frame.columns) == 2 + len(COLUMNS["runs"])
    assert frame["stress error [-]"].tolist() == [0.123456789012345678, 0.05, 0.5]
    assert csv_text(build(three)).splitlines()[1].startswith("disc,first,0.12345678901234568,")
    assert ",490," in csv_text(build(three)), "whole numbers stay whole"


def test_the_best_of_a_case_is_bold_and_a_run_alone_is_not(three):
    table = build(three)
    assert rows_of(markdown_text(table)) == [
        ["case", "method", "stress error [%]", "Dice [-]", "spread [%]"],
        ["disc", "first", "12.3", "0.877", "50.0"],
        ["disc", "second", "**5.00**", "**0.950**", "25.0"],
        ["ring", "first", "50.0", "0.500", "-"],
    ]
    latex = latex_text(table)
    assert r"disc & second & \textbf{5.00} & \textbf{0.950} & 25.0 \\" in latex
    assert r"stress error [\%]" in latex


def test_values_that_print_alike_are_marked_alike(tmp_path):
    errors = {"a": 0.050001, "b": 0.050002, "c": 0.06}
    paths = [evaluation(tmp_path, "disc", method, summary(error)) for method, error in errors.items()]
    assert {index for index, name in build(paths).best if name == "stress error"} == {0, 1}
    assert not build(paths[:2]).best, "where all print alike, none is the best"


def test_every_table_of_runs_ends_with_their_verdicts(three, tmp_path):
    assert "verdict" not in build(three).shown, "files without verdicts have no such column"
    stopped = summary(0.4, ending="out of iterations", verdict="warn: not converged")
    paths = [
        evaluation(tmp_path, "star", "a", stopped),
        evaluation(tmp_path, "star", "b", summary(0.4, verdict="pass")),
    ]
    table = build(paths)
    head, *rows = rows_of(markdown_text(table))
    assert head[-1] == "verdict" and [row[-1] for row in rows] == ["warn: not converged", "pass"]
    assert "hypernode verdict" in markdown_text(table) and "hypernode verdict" in latex_text(table)
    assert build(paths, columns=["verdict", "Dice"]).shown == ["verdict", "Dice"], "it is not shown twice"
    endings = pd.read_csv(io.StringIO(csv_text(table)))["ending"].fillna("").tolist()
    assert endings == ["out of iterations", ""], "methods that search for no field have no ending"


def test_a_table_of_unseen_loads_knows_the_verdict_from_the_evaluation(tmp_path):
    paths = [
        evaluation(tmp_path, "disc", "m", {"unseen_force_error": 0.1}, stage="validation"),
        evaluation(tmp_path, "disc", "m", summary(0.4, verdict="fail: forces")),
    ]
    table = build(paths, kind="validation", columns=[])
    assert table.frame["forces under unseen loads"].tolist() == [0.1]
    assert table.shown[-1] == "verdict" and table.frame["verdict"].tolist() == ["fail: forces"]


def test_a_number_says_which_deformation_it_was_judged_at(tmp_path):
    both = {"edge_force_error_measured": 0.04, "edge_force_error_identified": 0.01}
    path = evaluation(tmp_path, "disc", "m", summary(0.1, **both))
    names = ["stress error", "edge force error at measured F", "edge force error at identified F"]
    table = build([path], columns=names)
    assert rows_of(markdown_text(table))[1] == ["disc", "m", "10.0", "4.00", "1.00"]
    notes = markdown_text(table).splitlines()
    for name, words in zip(
        names, ("same prescribed deformation", "differentiated", "the method itself uses"), strict=True
    ):
        assert any(line.startswith(f"{name}: ") and words in line for line in notes)


def test_a_length_has_the_unit_of_the_sheet(tmp_path):
    path = evaluation(tmp_path, "specimen", "m", {"boundary_distance": 1.25}, length="mm")
    table = build([path], columns=["boundary distance"])
    assert rows_of(markdown_text(table)) == [["case", "method", "boundary distance [mm]"], ["specimen", "m", "1.25"]]


def test_a_group_has_the_statistics_of_its_members_and_counts_their_verdicts(tmp_path):
    errors = {"a": 0.1, "b": 0.2, "c": 0.6}
    ends = {"c": {"ending": "out of iterations", "verdict": "warn: not converged"}}
    paths = [evaluation(tmp_path, "disc", m, summary(e, **ends.get(m, {"verdict": "pass"}))) for m, e in errors.items()]
    table = build(paths, columns=["stress error"], groups={"all": "disc/*", "first": "disc/a"})
    frame = table.frame.set_index(["group", "statistic"])
    assert frame.loc[("all", "mean"), "stress error"] == pytest.approx(0.3)
    assert frame.loc[("all", "spread"), "stress error"] == pytest.approx((0.14 / 3) ** 0.5)
    assert frame.loc[("all", "median"), "stress error"] == 0.2
    assert frame.loc[("all", "largest"), "stress error"] == 0.6
    assert table.shown == ["stress error", "verdicts"]
    assert frame["verdicts"].tolist() == ["2 pass, 1 warn"] * 4 + ["1 pass"] * 4
    assert frame["not converged"].tolist() == [1] * 4 + [0] * 4
    best = {tuple(table.frame.loc[index, ["group", "statistic"]]) for index, _ in table.best}
    assert best == {("first", "mean"), ("first", "median")}


CASE = {
    "geometries": {"disc": {"shape": "disc", "radius": 0.25}},
    "materials": {"soft": {"model": "neo_hookean", "mu": 1.0}, "stiff": {"model": "neo_hookean", "mu": 2.0}},
    "loads": {"pull": {"kind": "uniaxial_x", "stretches": [1.1]}},
    "methods": {"m": {"baseline": "homogeneous"}},
    "cases": {"a": {"geometry": "disc", "inclusion": "stiff", "matrix": "soft", "loads": ["pull"], "methods": ["m"]}},
}


@pytest.mark.parametrize(("groups", "room"), [({}, 8), ({"all": "*"}, 7)])
def test_more_than_ten_columns_are_refused_with_what_to_do(groups, room):
    names = list(COLUMNS["runs"])
    fits = {"t": {"columns": names[:room], "groups": groups}}
    assert check_config(CASE | {"tables": fits}).tables["t"].columns == names[:room]
    with pytest.raises(ConfigError, match=rf"tables\.t.*columns: {room + 1} beside .*at most {room}"):
        check_config(CASE | {"tables": {"t": {"columns": names[: room + 1], "groups": groups}}})


def test_an_unknown_column_is_answered_with_the_one_that_was_meant():
    with pytest.raises(ConfigError, match=r"tables\.t\.columns\.0 = 'dice'.*did you mean 'Dice'"):
        check_config(CASE | {"tables": {"t": {"columns": ["dice"]}}})
