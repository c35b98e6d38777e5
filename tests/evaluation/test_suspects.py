"""A verdict that is not met names the cause whose pattern is there, and no cause where all is met."""

import numpy as np
import pytest

from hypernode.evaluation.force_courses import LAW, PAIRING, SCATTER, ZERO, Channel, probabilities
from hypernode.evaluation.level_budget import SHARE, LevelBudget, Part
from hypernode.evaluation.residual_patterns import pattern_of
from hypernode.evaluation.suspects import (
    FAINT,
    Evidence,
    _lines,
    displacement_suspects,
    forces_suspects,
    level_suspects,
    slope_suspects,
    with_suspects,
)
from hypernode.fem.mesh import rectilinear
from hypernode.verdict import Criterion, Level, Suspect, Verdict
from tests.evaluation.files import square_mesh

CELLS, STEPS, SEEDS = 16, 6, 20
MESH = square_mesh(CELLS)
X = MESH.nodes
DEFORMATION = 0.05 * np.arange(1, STEPS + 1)
LINES = np.abs(X[:, 0] - 0.5) < 1.5 / CELLS
NONE = np.zeros(len(X), bool)
#: Smooth over the sheet, and no motion of a camera.
SMOOTH = np.column_stack([np.sin(3 * X[:, 0]) * np.cos(5 * X[:, 1]), np.cos(4 * X[:, 0] * X[:, 1] * 3)])
SMOOTH = (SMOOTH - SMOOTH.mean(axis=0)) / SMOOTH.std(axis=0)


def residual(part, seed, size=1.0):
    """Noise of one and a part (step, node, 2)."""
    return np.random.default_rng(seed).normal(size=(STEPS, len(X), 2)) + size * part


def growing(power, field):
    shape = (DEFORMATION / DEFORMATION.max()) ** power
    return shape[:, None, None] * field / np.sqrt(np.mean(shape**2))


def first(part, lines=NONE, seed=0):
    pattern = pattern_of(MESH, residual(part, seed), DEFORMATION, lines)
    return max(displacement_suspects(pattern, 1.4), key=lambda each: each.weight).name


def weights(missed, seed, noise=2e-3):
    force = 10.0 * (1.0 + DEFORMATION - (1.0 + DEFORMATION) ** -2)
    scatter = noise * force * np.random.default_rng(seed).normal(size=STEPS)
    return probabilities(Channel(force, missed(force) + scatter, 1.0 + DEFORMATION, np.arange(STEPS)), 1e-3)


def likely(missed, seed):
    found = weights(missed, seed)
    return max(found, key=found.get)


def share_of_seeds(answer, name):
    return np.mean([answer(seed) == name for seed in range(SEEDS)])


@pytest.mark.parametrize(
    ("name", "part", "lines"),
    [
        ("noise", np.sqrt(1.0) * np.random.default_rng(99).normal(size=(STEPS, len(X), 2)), NONE),
        ("noise", np.repeat(np.random.default_rng(98).normal(size=(1, len(X), 2)), STEPS, axis=0), NONE),
        ("law", growing(2, SMOOTH), NONE),
        ("law", growing(1, SMOOTH), NONE),
        ("mesh", growing(1, 3.0 * LINES[:, None] * np.ones(2)), LINES),
        ("camera", growing(1, np.column_stack([X[:, 0] - 0.5, 2.0 * (X[:, 1] - 0.5)]) * 3.0), NONE),
    ],
    ids=["noise told too small", "reference picture", "law that stiffens otherwise", "law", "lines", "camera"],
)
def test_displacements_that_are_missed_have_the_pattern_of_their_cause(name, part, lines):
    assert share_of_seeds(lambda seed: first(part, lines, seed), name) == 1.0


MISSED = {
    ZERO: lambda force: np.full_like(force, 0.03 * force.max()),
    LAW: lambda force: 0.06 * force * (DEFORMATION - DEFORMATION.mean()) / np.ptp(DEFORMATION),
    PAIRING: lambda force: 0.5 * np.gradient(force),
    SCATTER: lambda force: 0.0 * force,
}


@pytest.mark.parametrize("name", [LAW, SCATTER])
def test_forces_that_are_missed_have_the_course_of_their_cause(name):
    assert share_of_seeds(lambda seed: likely(MISSED[name], seed), name) >= 0.9


@pytest.mark.parametrize("name", [ZERO, PAIRING])
def test_a_zero_and_a_lag_are_both_named_and_no_other(name):
    found = [weights(MISSED[name], seed) for seed in range(SEEDS)]
    named = [{cause for cause, weight in each.items() if weight > FAINT} for each in found]
    assert np.mean([name in each for each in named]) >= 0.9
    assert np.mean([each <= {ZERO, PAIRING} for each in named]) >= 0.9


def test_a_zero_and_a_lag_are_alike_where_the_force_grows_evenly():
    force = 10.0 * DEFORMATION
    channel = Channel(force, np.full(STEPS, 0.1), 1.0 + DEFORMATION, np.arange(STEPS))
    found = {each.name: each.weight for each in forces_suspects([channel])}
    assert found[ZERO] == pytest.approx(found[PAIRING])
    assert found[ZERO] > 0.4


def test_the_largest_part_of_the_budget_is_the_first_suspect_of_the_level():
    budget = LevelBudget((Part.stated("zero", 0.01, 0.02), Part.found(SHARE, 0.1, "field")), 0.6)
    assert max(level_suspects(budget), key=lambda each: each.weight).name == SHARE


def test_a_stiffness_along_a_plane_may_be_a_thickness_and_an_even_one_is_not():
    (told,) = slope_suspects((0.1, 0.95), None)
    assert told.name == "thickness"
    assert "10 %" in told.sentence
    assert not slope_suspects((0.01, 0.95), None)
    assert not slope_suspects((0.1, 0.2), None)


def evidence(**changed):
    pattern = pattern_of(MESH, residual(growing(2, SMOOTH), 0), DEFORMATION, NONE)
    budget = LevelBudget((Part.stated("zero", 0.1),), 1.0)
    plain = {"pattern": pattern, "channels": (), "budget": budget, "too_noisy": 1.4, "predicted": None, "slope": None}
    return Evidence(**(plain | changed))


def verdict(**levels):
    return Verdict(tuple(Criterion(name, level, "") for name, level in levels.items()))


def test_only_what_is_not_met_has_suspects():
    assert with_suspects(verdict(displacements=Level.PASSED, level=Level.PASSED), evidence()).suspects == ()
    assert [each.name for each in with_suspects(verdict(level=Level.WARNED), evidence()).suspects] == ["zero"]


def test_what_fails_comes_before_what_warns():
    found = with_suspects(verdict(displacements=Level.WARNED, level=Level.FAILED), evidence())
    assert [each.name for each in found.suspects][:2] == ["zero", "law"]


def test_suspects_stand_in_the_file_of_a_verdict():
    told = Verdict(verdict(forces=Level.FAILED).criteria, (Suspect("law", 0.8, "It grows."),))
    assert Verdict.of(told.stored()) == told
    assert told.causes == ["Suspect: law. It grows."]


def test_lines_are_between_both_sides_of_the_shape_where_no_phases_are_told():
    mesh = rectilinear(np.arange(5.0), np.arange(3.0))
    shape = (mesh.centres[:, 0] > 2.0).astype(int)
    near = _lines(mesh, {}, {"shape": shape})
    assert near[np.abs(mesh.nodes[:, 0] - 2.0) <= 1.0].all() and not near[np.abs(mesh.nodes[:, 0] - 2.0) > 1.0].any()


def test_a_load_cell_in_order_does_not_acquit_another_one():
    force = 10.0 * DEFORMATION
    wrong = Channel(force, np.full(STEPS, 0.1), 1.0 + DEFORMATION, np.arange(STEPS) ** 2.0)
    right = Channel(force, np.zeros(STEPS), 1.0 + DEFORMATION, np.arange(STEPS) ** 2.0)
    found = {each.name: each.weight for each in forces_suspects([wrong, right])}
    assert found[ZERO] > 0.3 and found.get("noise", 0.0) < 0.1
