"""What a search tried is kept with its scores, and why one candidate was kept."""

import json
from dataclasses import replace

import numpy as np
import pytest

from hypernode import cli
from hypernode.commands.explain import reasons
from hypernode.config.methods import Constrained
from hypernode.identification.choice import likeliest
from hypernode.identification.gauss_newton import descend
from hypernode.identification.problem import field_problem
from hypernode.mechanics.loads import make_load
from hypernode.storage.netcdf import SYNTHETIC_UNITS, write
from hypernode.trace import KEPT, Score, Trace, Trial, read, stored, table
from tests.sheets import sheet, square


def score(total):
    return Score(displacements=total, forces=0.0, prior=0.0, noise=0.0, terms=0.0, determined=0.0)


def trial(move, total, start=None, materials=0):
    misfits = {"displacement": 1.0, "force": 0.5}
    return Trial(
        move=move,
        start=start,
        terms=("I2",),
        materials=materials,
        misfits=misfits,
        score=score(total),
        ending="converged",
    )


def test_every_candidate_stays_in_the_record_with_the_last_reason_against_it():
    plain, rich, lines = trial("plain", 9.0), trial("rich", 5.0), trial("lines", 3.0, materials=2)
    first = Trace().with_trial(plain)
    both = (first | Trace().with_trial(rich)).passed_over({plain: "scores +4.0"})
    every = (both | first | Trace().with_trial(lines)).passed_over({rich: "scores +2.0"})
    rows = every.rows(lines)
    assert [row["move"] for row in rows] == ["plain", "rich", "lines"]
    assert [row["reason"] for row in rows] == ["scores +4.0", "scores +2.0", KEPT]
    assert read({"trace": stored(rows)}) == json.loads(json.dumps(rows))


def test_the_table_has_scores_over_the_kept_one_and_the_sentences_say_by_which_part():
    plain = trial("plain", 9.0)
    lines = trial("lines", 3.0, start=plain, materials=2)
    rows = Trace().with_trial(plain).with_trial(lines).rows(lines)
    head, first, second = table(rows)
    assert "+6.0" in first and "+0.0" in second and "tried" in head
    kept, against = reasons(rows)
    assert kept.startswith("Kept: 2 materials with the terms I2")
    assert "displacements +6.0" in against


@pytest.fixture(scope="module")
def noisy():
    data, _, _ = sheet(6, square, make_load("equibiaxial", [1.1, 1.2]), noise=1e-3)
    return data


def test_a_descent_is_recorded_and_the_likeliest_of_two_says_why_not_the_other(noisy):
    settings = Constrained(terms=[], iterations=6)
    plain = descend(field_problem(noisy, settings), settings, "square", None, 0.0, "plain")
    richer = settings.model_copy(update={"terms": ["I1_squared"]})
    rich = descend(field_problem(noisy, richer), richer, "square", plain, 0.0, "rich")
    kept = likeliest(plain, rich)
    rows = kept.trace.rows(kept.trial)
    assert [row["move"] for row in rows] == ["plain", "rich"]
    assert rows[1]["start"] == 1 and sum(row["reason"] == KEPT for row in rows) == 1
    assert kept.score.total == pytest.approx(min(row["total"] for row in rows))


def test_the_score_of_a_field_does_not_depend_on_how_its_residuals_are_scaled(noisy):
    settings = Constrained(terms=[], iterations=4)
    found = descend(field_problem(noisy, settings), settings, "square", None, 0.0)
    # The same uncertainty of every point, divided otherwise between what is common and what is relative.
    other = field_problem(noisy, settings)
    boundaries = tuple(
        replace(each, observe=2.0 * each.observe, seen=2.0 * each.seen, relative=0.5 * each.relative)
        for each in other.observations.boundaries
    )
    other.observations = replace(other.observations, boundaries=boundaries, sigma=2.0 * other.observations.sigma)
    again = descend(other, settings, "square", None, 0.0)
    assert np.isclose(again.score.total, found.score.total, rtol=0.0, atol=1e-3)


def test_the_command_prints_table_and_reasons_and_says_what_to_name_otherwise(tmp_path, capsys):
    plain = trial("plain", 9.0)
    lines = trial("lines", 3.0, start=plain, materials=2)
    rows = Trace().with_trial(plain).with_trial(lines).rows(lines)
    run = tmp_path / "results/sheet/field"
    write(run / "constrained.nc", {}, "field", {"units": SYNTHETIC_UNITS, "trace": stored(rows)})
    assert cli.main(["explain", str(run)]) == 0
    printed = capsys.readouterr().out
    assert "Kept: 2 materials" in printed and "Not a material in every cell" in printed
    assert cli.main(["explain", str(tmp_path)]) == 2
    assert "results/CASE/METHOD" in capsys.readouterr().err
