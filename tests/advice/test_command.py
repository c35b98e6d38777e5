"""The command advise: what it prints, for people and machines, and which runs it refuses with which sentence."""

import json

import pytest
import xarray as xr

from hypernode import cli
from hypernode.advice.further_test import Advice, AdviceError, FurtherTest
from hypernode.commands.advise import listing
from hypernode.stages import advice as stage
from tests.figures.data import verdict

NAN = float("nan")
FOUND = Advice(
    0.05,
    2.0,
    (
        FurtherTest("equibiaxial", 0.02, 0.6, 0.03),
        FurtherTest("shear", 0.04, 0.2, 0.01),
        FurtherTest("sheet, larger", NAN, NAN, NAN, refused="no equilibrium: load step 1"),
    ),
)


@pytest.fixture
def asked(monkeypatch):
    """What the stage was asked, which answers :data:`FOUND`; JAX stays as the tests have set it up."""
    calls = []
    monkeypatch.setattr("hypernode.pipeline.compiler.set_up_compiler", lambda float64: None)
    monkeypatch.setattr(stage, "run", lambda *arguments: calls.append(arguments) or FOUND)
    return calls


def test_the_table_ranks_tests_and_ends_with_the_one_worth_doing(asked, capsys):
    assert cli.main(["advise", "results/c/m", "--larger", "1.3", "--probes", "4"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines == listing(FOUND)
    assert lines[0] == "spread of the stress now: 5.00 %"
    assert lines[3].split() == ["equibiaxial", "2.00", "%", "60.0", "±", "3.0", "%"]
    assert lines[5] == "sheet, larger  no equilibrium: load step 1"
    assert lines[-1].startswith("The next test worth doing is equibiaxial: ")
    assert [call[1:] for call in asked] == [(1.3, 4)]


def test_json_and_csv_hold_every_number_and_null_where_there_is_none(asked, capsys):
    assert cli.main(["advise", "results/c/m", "--json"]) == 0
    said = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    assert said["spread"] == 0.05 and said["sentence"] == FOUND.sentence
    assert [test["spread"] for test in said["tests"]] == [0.02, 0.04, None]
    assert cli.main(["advise", "results/c/m", "--csv"]) == 0
    rows = capsys.readouterr().out.splitlines()
    assert rows[0] == "name,spread,reduction,uncertainty,refused"
    assert rows[1] == "equibiaxial,0.02,0.6,0.03," and rows[3].startswith('"sheet, larger",,,,')


@pytest.mark.parametrize(("words", "why"), [(["--larger", "1"], "more than one"), (["--probes", "1"], "two or more")])
def test_options_without_meaning_are_refused(words, why, asked, capsys):
    assert cli.main(["advise", "results/c/m", *words]) == 2
    assert why in capsys.readouterr().err and not asked


def believed(level="pass", forces="measured", name="displacements", field=True):
    stored = verdict(level)
    for criterion in stored["criteria"]:
        if criterion["level"] == "fail":
            criterion["name"] = name
    files = {
        "evaluation": xr.Dataset(attrs={"verdict": json.dumps(stored)}),
        "measurement": xr.Dataset(attrs={"forces": forces}),
    }
    return files | ({"constrained": xr.Dataset()} if field else {})


@pytest.mark.parametrize(
    ("files", "why"),
    [
        (believed("fail"), "the verdict is fail, and a field .* over their noise is 3.21"),
        (believed(forces="assumed"), "the next test worth doing is the same one with its force"),
        (believed(field=False), "has no equilibrium field to ask"),
    ],
)
def test_a_run_is_refused_that_does_not_explain_its_test_has_no_force_or_no_field(files, why):
    with pytest.raises(AdviceError, match=why):
        stage._believed("c/m", files)


def test_a_run_that_is_uncertain_or_warned_of_is_just_what_one_asks_for():
    for files in (believed("fail", name="uncertainty"), believed("warn"), believed()):
        assert stage._believed("c/m", files) is None
