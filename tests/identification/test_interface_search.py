"""A sheet of a few materials and lines: what it is made of is found, and why is recorded."""

from types import SimpleNamespace

import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.identification.interface_search import Search
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.law_search import turned
from hypernode.identification.left_out import predict_left_out
from hypernode.identification.lines import Lines
from hypernode.identification.problem import field_problem
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.strategy import of_parts
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.mechanics.loads import make_load
from tests.sheets import believed, observed_coarsely

NOISE, CELLS = 2e-4, 12
SETTINGS = Constrained(terms=["I1_squared", "I2"], layers=True)
LOAD = make_load("equibiaxial", [1.05, 1.1, 1.15])


def disc(X):
    return (np.linalg.norm(X - [0.48, 0.53], axis=1) < 0.27).astype(float)


def two_discs(X):
    """One inclusion of twice the stiffness of the sheet, and one of half."""
    stiff = np.linalg.norm(X - [0.3, 0.33], axis=1) < 0.2
    return stiff - 1.0 * (np.linalg.norm(X - [0.68, 0.68], axis=1) < 0.2)


def observed(inclusion, load=LOAD, level=NOISE, **material):
    """(noisy measurement of every second node of finite elements, share of the inclusion in every cell)."""
    data, share = observed_coarsely(CELLS, inclusion, load, 0.0, **material)
    noise = np.random.default_rng(3).normal(0.0, level, data["u_measured"].shape)
    data = believed(data.assign(u_measured=data["u_measured"] + noise), level)
    return data.assign_attrs(mesh="finer", noise_uncertainty=0.05), share


@pytest.fixture(scope="module")
def of_a_disc():
    data, share = observed(disc)
    return of_parts(data, SETTINGS, "sheet").found, share


def test_two_materials_and_the_line_between_them_are_found(of_a_disc):
    found, share = of_a_disc
    assert found.material_count == 2 and found.layered
    soft, stiff = np.sort(np.exp(found.field.materials[:, 0]))
    assert stiff / soft == pytest.approx(2.0, rel=0.02)
    of = found.field.grid_cells()
    covered = (of.one == 1).astype(float)
    covered[of.cell] = of.share
    stiffest = found.field.materials[1, 0] > found.field.materials[0, 0]
    assert np.abs((covered if stiffest else 1.0 - covered) - share).mean() < 0.02


def test_the_answer_explains_the_test_and_its_noise(of_a_disc):
    found, _ = of_a_disc
    assert found.unexplained <= 1.0
    assert found.misfits["displacement"] == pytest.approx(1.0, abs=0.1)
    left_out = predict_left_out(found)
    assert left_out.displacement == pytest.approx(1.0, abs=0.2)


def test_the_record_says_why_two_materials_and_why_these_terms(of_a_disc):
    found, _ = of_a_disc
    rows = found.trace.rows(found.trial)
    assert rows[0]["move"] == "one material" and "2 materials" in rows[0]["reason"]
    assert rows[-1]["reason"] == "kept"
    assert {row["move"] for row in rows} >= {"2 materials and lines", "finer elements"}
    assert rows[-1]["promises"]["I1_squared"] < 0.0
    assert all(row["reason"] for row in rows)


def test_samples_are_of_the_materials_and_as_far_from_the_answer_as_it_is_uncertain(of_a_disc):
    found, _ = of_a_disc
    samples, best = found.samples(400, seed=1), found.by_parts
    assert samples.shape == (len(found.basis.names), 400, 1, CELLS**2)
    labels = found.labels
    for k in range(2):
        own = samples[0, :, 0, labels == k]
        assert np.ptp(own, axis=0).max() == 0.0
    assert np.abs(samples[0].mean(axis=0) - best[0]).max() < 3.0 * samples[0].std(axis=0).max() / 20.0
    assert 0.0 < samples[0].std(axis=0).max() < 0.05


def test_a_cell_that_a_line_cuts_has_the_stress_of_its_layers(of_a_disc):
    found, _ = of_a_disc
    F = np.tile(np.diag([1.1, 1.1]), (1, CELLS**2, 1, 1))
    jump, cut = found.jump_stress(F), found.field.grid_cells().cell
    elsewhere = np.setdiff1d(np.arange(CELLS**2), cut)
    assert len(cut) and not jump[:, elsewhere].any() and np.abs(jump[:, cut]).max() > 0.0


def test_a_homogeneous_sheet_is_of_one_material():
    data, _ = observed(lambda X: np.zeros(len(X)))
    found = of_parts(data, SETTINGS, "sheet").found
    assert found.material_count == 1 and not found.layered
    assert np.exp(found.field.materials[0, 0]) == pytest.approx(1.0, rel=0.01)


@pytest.mark.slow
def test_two_materials_that_differ_only_in_the_direction_of_their_fibres_are_told_apart():
    along, across = {"fibre_x": 0.5, "fibre_y": 0.0}, {"fibre_x": -0.2, "fibre_y": 0.45}
    data, share = observed(disc, terms=("fibre",), values=along, inside=across)
    found = of_parts(data, SETTINGS.model_copy(update={"terms": ["fibre"]}), "sheet").found
    assert found.material_count == 2
    whole = (share == 0.0) | (share == 1.0)
    inside = found.labels == found.labels[share.argmax()]
    assert (inside[whole] == (share[whole] == 1.0)).mean() > 0.97
    names = list(found.basis.names)
    for labels, true in ((~inside, along), (inside, across)):
        material = found.field.materials[np.bincount(found.labels[labels & whole]).argmax()]
        angles = [
            np.arctan2(each["fibre_y"], each["fibre_x"]) for each in (dict(zip(names, material, strict=True)), true)
        ]
        assert abs(np.angle(np.exp(1j * (angles[0] - angles[1])))) < 0.1


@pytest.mark.slow
@pytest.mark.parametrize("law", [{}, {"log1p_I2": 1.0}])
def test_what_coarse_elements_miss_beside_clamps_is_no_change_of_the_material(law):
    clamped = make_load("clamped_y", [1.05, 1.1, 1.15])
    data, _ = observed(lambda X: np.zeros(len(X)), clamped, 5e-5, terms=("I2",) if law else (), values=law)
    found = of_parts(data, SETTINGS, "sheet").found
    assert found.material_count == 1 and not len(found.field.gradual)
    assert found.basis.terms == (("I2",) if law else ())
    assert found.misfits["displacement"] < 1.1


@pytest.mark.slow
def test_three_materials_have_lines_of_their_own():
    data, _ = observed(two_discs)
    found = of_parts(data, SETTINGS, "sheet").found
    assert found.material_count == 3 and len(found.distances) == 2
    soft, sheet, stiff = np.sort(np.exp(found.field.materials[:, 0]))
    assert stiff / sheet == pytest.approx(2.0, rel=0.05)
    assert soft / sheet == pytest.approx(0.5, rel=0.05)


@pytest.mark.slow
def test_a_statement_that_the_grid_is_the_mesh_is_not_believed_where_whole_cells_leave_more_than_noise():
    data, _ = observed(disc)
    found = of_parts(data.assign_attrs(mesh="measured_grid"), SETTINGS, "sheet").found
    assert found.material_count == 2 and found.layered


def test_few_materials_are_sought_only_where_they_are_asked_for():
    data, _ = observed(disc)
    assert of_parts(data, SETTINGS.model_copy(update={"layers": False}), "sheet").found is None


@pytest.fixture(scope="module")
def cut_sheet():
    """(a test, a field whose line cuts cells, its states, moves of the line, how the test answers to its numbers)."""
    data, share = observed(disc)
    problem = field_problem(data, SETTINGS.model_copy(update={"terms": ["I2"]}), 2, 1e-6)
    lines = Lines.of(problem.observations.grid, problem.refinement)
    field = Interfaces(lines, np.array([[0.0, 0.2], [0.6, 0.1]]), lines.grid.through(share)[None] + 0.013)
    test = SeenTest(problem, [1])
    u = problem.equilibrium.extension(np.zeros((len(problem.mesh.cells), 2)))
    states, moves = test.states(field, [u[1]]), field.moves(1.3)
    return test, field, states, moves, list(test.answers(states, test.loads(field, states, moves)))


def test_the_jacobian_is_the_derivative_of_the_equilibrium(cut_sheet):
    """By every number of the field, through the finite elements, against differences of solved equilibria."""
    test, field, states, moves, (answer,) = cut_sheet
    y, step, J = field.numbers(moves), 1e-5, answer.over(test.sigma)
    chosen = [*range(4), *(4 + np.argsort(-np.abs(J[:, 4:]).max(axis=0))[:3])]
    for number in chosen:
        moved = []
        for sign in (1.0, -1.0):
            changed = y.copy()
            changed[number] += sign * step
            reached = test.states(field.at(changed, moves), [states[0][0]])
            moved.append(test.residuals(reached, test.sigma)[0])
        difference = (moved[0] - moved[1]) / (2.0 * step)
        assert np.abs(J[:, number] - difference).max() < 1e-3 * np.abs(difference).max()


def test_a_guess_that_follows_numbers_misses_equilibrium_by_the_square_of_their_change(cut_sheet):
    test, field, states, moves, answers = cut_sheet
    y, direction, missed = field.numbers(moves), np.zeros(len(field.numbers(moves))), []
    direction[[0, 3, 6]] = 1.0, 0.5, 1.0
    for size in (0.1, 0.05):
        reached = test.followed(field.at(y + size * direction, moves), states, answers, size * direction)
        missed.append(np.abs(answers[0].near(states[0][0], size * direction) - reached[0][0]).max())
    assert missed[1] < 0.3 * missed[0]


@pytest.mark.slow
def test_a_window_that_nobody_stated_is_found():
    window = 2.0 / CELLS
    data, _ = observed_coarsely(CELLS, disc, LOAD, window)
    noise = np.random.default_rng(3).normal(0.0, NOISE, data["u_measured"].shape)
    data = believed(data.assign(u_measured=data["u_measured"] + noise), NOISE)
    data = data.assign_attrs(mesh="finer", noise_uncertainty=0.05, window_uncertainty=0.25, correlation_window=0.0)
    found = Search(data, SETTINGS, "sheet").end()
    believed_window = found.problem.observations.believed_window
    assert abs(believed_window.side - window) < 3.0 * believed_window.error
    assert believed_window.side == pytest.approx(window, rel=0.15)
    assert found.material_count == 2


def test_fibres_may_begin_in_four_directions_and_other_terms_in_one_way():
    problem = SimpleNamespace(basis=ConvexBasis(("fibre",), 0.5))
    begun = np.tile(problem.basis.start, (2, 1))
    four = turned(begun, problem, "fibre")
    vectors = np.array([each[0, 1:3] for each in four])
    assert len(four) == 4 and np.allclose(np.hypot(*vectors.T), 0.1) and np.allclose(vectors.sum(axis=0), 0.0)
    assert [each is begun for each in turned(begun, problem, "I2")] == [True]


@pytest.mark.slow
def test_two_materials_that_change_gradually_by_the_same_factor_are_told_from_it():
    load = make_load("clamped_y", [1.05, 1.1, 1.15])
    data, _ = observed(lambda X: disc(X) + 0.8 * (X[:, 1] - 0.5), load, level=0.3 * NOISE)
    found = of_parts(data, SETTINGS, "sheet").found
    assert found.material_count == 2 and found.gradual
    soft, stiff = np.sort(np.exp(found.field.materials[:, 0]))
    assert stiff / soft == pytest.approx(2.0, rel=0.03)
    grid = found.problem.observations.grid
    slope, _ = np.polyfit(grid.centres[:, 1], found.field.grid_factor(), 1)
    assert slope == pytest.approx(0.8 * np.log(2.0), rel=0.1)
