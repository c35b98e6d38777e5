"""Advice on the next test: laws of information, and what two tests really tell."""

import json

import numpy as np
import pytest
import xarray as xr

from hypernode.advice.candidates import Candidate, candidates, present_loads, standard_loads
from hypernode.advice.further_test import Advice, AdviceError, FurtherTest, advise, linearised
from hypernode.advice.simulation import recorded
from hypernode.advice.stress_spread import StressSpread, traces
from hypernode.config.methods import Constrained
from hypernode.fem.mesh import EDGE_NAMES
from hypernode.identification.gauss_newton import descend, objective_at_end
from hypernode.identification.problem import field_problem, problem_of_basis
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.mechanics.loads import make_load
from hypernode.mechanics.modes import mode_gradients
from tests.sheets import SCALE, believed, sheet, square

SETTINGS = Constrained(terms=["I1_squared"], iterations=6)
CELLS, STRETCHES, NOISE = 6, [1.1, 1.2], 1e-3


def measured(kind="uniaxial_x", noise=NOISE, cells=CELLS, seed=5):
    stretches = [(1.0 + s, 1.0 + s) if kind == "biaxial" else 1.0 + s for s in (0.1, 0.2)]
    data, _, true = sheet(cells, square, make_load(kind, stretches), noise=noise, seed=seed)
    return data.assign_attrs(load_cases=json.dumps([kind])), true


def done(kind):
    """What a measurement says of a load, without what was measured."""
    load = make_load(kind, [(s, s) if kind == "biaxial" else s for s in STRETCHES])
    held = np.zeros((2, 4, 2))
    for edge, i in load.constrained:
        held[:, EDGE_NAMES.index(edge), i] = 1.0
    variables = {"H": (("load_step", "i", "J"), load.H), "load_case": (("load_step",), np.zeros(2, int))}
    variables |= {"edge_constrained": (("load_step", "edge", "i"), held)}
    return xr.Dataset(variables, attrs={"load_cases": json.dumps([kind])})


def together(*tests):
    """Tests of one sheet as the load cases of one measurement."""
    each = [test.assign(load_case=test["load_case"] * 0 + k) for k, test in enumerate(tests)]
    sheet_only = ["X", "cells", "corners", "relative_thickness"]
    steps = xr.concat([test.drop_vars(sheet_only) for test in each], "load_step")
    both = steps.assign({key: tests[0][key] for key in sheet_only})
    both["u_measured"] = both["u_measured"].transpose("repeat", "load_step", "node", "i")
    names = [name for test in tests for name in json.loads(test.attrs["load_cases"])]
    return both.assign_attrs(tests[0].attrs | {"load_cases": json.dumps(names)})


@pytest.fixture(scope="module")
def present():
    data, true = measured()
    problem = problem_of_basis(data, SETTINGS, ConvexBasis(("I1_squared",), SCALE))
    states = problem.equilibrium.states(true, problem.equilibrium.extension(true))
    linear = problem.linearise(true, states, problem.sigma)
    return data, true, problem, states, linear


def spread_of(problem, params, count=8):
    return StressSpread(
        objective=objective_at_end(problem, SETTINGS, params), params=params, stretches=STRETCHES, count=count, seed=0
    )


def advised(present, tests):
    data, params, problem, states, _ = present
    return advise(problem, params, [state.u for state in states], data, SETTINGS, tests, STRETCHES, "sheet")


def test_the_spread_is_that_of_the_inverse_of_the_whole_precision(present):
    _, params, problem, _, linear = present
    spread = spread_of(problem, params, count=12)
    objective = objective_at_end(problem, SETTINGS, params)
    R, _, B = objective._jump_roots(params)
    jumps = np.zeros((params.size, params.size))
    for k, block in enumerate(B):
        at = slice(k * len(block), (k + 1) * len(block))
        jumps[at, at] = block
    jumps = jumps.T @ (R.T @ R).toarray() @ jumps
    H = linear.nearly_curvature(np.eye(params.size)) + jumps + np.diag(objective.ridge)
    F, h = np.moveaxis(mode_gradients(STRETCHES).reshape(-1, 2, 2), 0, -1), 1e-5
    S = np.zeros((len(params), F[0, 0].size * 4, params.size))
    size = 0.0
    for cell, p in enumerate(params):
        size += np.sum(np.asarray(problem.basis.stress(F, p[:, None])) ** 2)
        for k in range(len(p)):
            step = h * np.eye(len(p))[k]
            ends = [np.asarray(problem.basis.stress(F, (p + sign * step)[:, None])) for sign in (1, -1)]
            S[cell, :, cell * len(p) + k] = (ends[0] - ends[1]).ravel() / (2 * h)
    S = S.reshape(-1, params.size)
    exact = np.trace(S @ np.linalg.solve(H, S.T)) / size
    found = spread.variances([linear.nearly_curvature])
    assert found.mean() == pytest.approx(exact, rel=0.1)


def test_a_trace_is_exact_where_few_directions_make_it_up_and_without_bias_where_not():
    random = np.random.default_rng(0)
    roots = random.normal(size=(40, 3)), random.normal(size=(40, 40))
    for A, allowed in ((roots[0] @ roots[0].T, 1e-9), (roots[1] @ roots[1].T, 0.02)):
        found = []
        for _ in range(100):
            signs = random.choice([-1.0, 1.0], (40, 6))
            found.append(traces(signs, A @ signs).mean())
        assert np.mean(found) == pytest.approx(np.trace(A), rel=allowed)


def test_adding_a_test_never_increases_the_spread(present):
    data, params, problem, _, linear = present
    spread, after = spread_of(problem, params), []
    for test in (standard_loads([0.1, 0.2])[k] for k in (0, 5)):
        further = linearised(problem, params, test, data, SETTINGS, 0)
        after.append([linear.nearly_curvature, further.nearly_curvature])
    first, second = (spread.variances(each).mean() for each in after)
    every = spread.variances([*after[0], after[1][1]]).mean()
    assert every < min(first, second) <= max(first, second) < spread.variances([linear.nearly_curvature]).mean()


def test_the_same_test_again_tells_what_twice_the_data_do(present):
    data, params, problem, _, linear = present
    again = spread_of(problem, params).variances([linear.nearly_curvature] * 2)
    twice = problem_of_basis(together(data, data), SETTINGS, problem.basis)
    states = twice.equilibrium.states(params, twice.equilibrium.extension(params))
    doubled = spread_of(problem, params).variances([twice.linearise(params, states, twice.sigma).nearly_curvature])
    np.testing.assert_allclose(again, doubled, rtol=1e-6)
    before = spread_of(problem, params).variances([linear.nearly_curvature])
    assert 0.5 * before.mean() < again.mean() < before.mean(), (
        "jumps and ridge are no data, so that less than half of a variance is gained"
    )


def test_a_simulated_test_tells_what_the_real_one_of_its_load_does(present):
    data, params, problem, _, linear = present
    test = Candidate("uniaxial x", make_load("uniaxial_x", STRETCHES))
    further = linearised(problem, params, test, data, SETTINGS, seed=1)
    spread = spread_of(problem, params)
    real, simulated = (spread.variances([each.nearly_curvature]).mean() for each in (linear, further))
    assert simulated == pytest.approx(real, rel=0.1)


def test_a_simulated_test_records_what_the_machine_can_tell_and_the_sheet_under_its_load(present):
    data, params, problem, _, _ = present
    test = Candidate("shear", make_load("shear", STRETCHES))
    further = recorded(problem, params, test, data, 0)
    assert np.isfinite(further["edge_force"].values).sum() == 2 * 2, "the shear force on two edges in two steps"
    truth, _ = measured("shear", noise=0.0)
    error = further["u_measured"].values - truth["u_measured"].values
    assert error.std() == pytest.approx(NOISE, rel=0.1)
    known = np.isfinite(further["edge_force"].values)
    np.testing.assert_allclose(further["edge_force"].values[known], truth["edge_force"].values[known], rtol=1e-6)


@pytest.mark.slow
def test_the_predicted_ranking_is_that_of_identifications_with_two_tests():
    """Of a uniaxial test along x; what each pair leaves open where it was really identified."""
    data, true = measured(cells=8)
    problem = field_problem(data, SETTINGS)
    found = descend(problem, SETTINGS, "one", None, SETTINGS.tolerance)
    kinds = {"equibiaxial": "biaxial", "uniaxial y": "uniaxial_y", "uniaxial_x again": "uniaxial_x"}
    tests = [each for each in candidates(data) if each.name in kinds]
    guesses = [state.u for state in found.states]
    predicted = advise(problem, found.params, guesses, data, SETTINGS, tests, STRETCHES, "one")
    left = {}
    for name, kind in kinds.items():
        pair = together(data, measured(kind, cells=8, seed=7)[0])
        both = descend(field_problem(pair, SETTINGS), SETTINGS, name, None, SETTINGS.tolerance)
        spread = StressSpread(objective=both.objective, params=both.params, stretches=STRETCHES, count=8, seed=0)
        left[name] = spread.variances([both.linear.nearly_curvature]).mean()
    assert [test.name for test in predicted.tests] == sorted(left, key=left.get)
    assert true.shape == found.params.shape


def test_a_test_that_was_done_is_asked_for_again_and_larger_and_not_as_another_one():
    data = done("biaxial")
    names = [each.name for each in candidates(data)]
    assert names == ["uniaxial x", "uniaxial y", "strip x", "strip y", "shear", "biaxial, larger", "biaxial again"]
    np.testing.assert_allclose(candidates(data, larger=2.0)[-2].load.H, 2.0 * data["H"].values)
    kinds = ["clamped_y", "shear", "uniaxial_y", "general"]
    with_shear = done("shear").assign(H=done("shear")["H"] + np.diag([-0.01, 0.0]))
    loads = [present_loads(each)[0][1] for each in (done("clamped_y"), with_shear, done("uniaxial_y"), done("general"))]
    assert [load.kind for load in loads] == kinds
    np.testing.assert_allclose(loads[1].H, done("shear")["H"].values, err_msg="of what is free nothing is prescribed")


def test_a_test_without_equilibrium_is_named_last_with_its_reason(present):
    apart = Candidate("torn", make_load("uniaxial_x", [-0.5]))
    again = Candidate("again", None)
    tests = advised(present, [apart, again]).tests
    assert [test.name for test in tests] == ["again", "torn"]
    assert tests[1].refused.startswith("no equilibrium: load step 0") and np.isnan(tests[1].spread)


def test_exact_displacements_leave_nothing_open(present):
    data, params, problem, _, _ = present
    exact = problem_of_basis(believed(data, 0.0), SETTINGS, problem.basis)
    with pytest.raises(AdviceError, match="the displacements are exact"):
        advise(exact, params, [], data, SETTINGS, [], STRETCHES, "sheet")


def test_the_sentence_names_what_is_worth_doing_and_what_cannot_be_told_from_it():
    def ranked(*reductions):
        tests = [FurtherTest(f"t{k}", 0.1 * (1.0 - r), r, 0.02) for k, r in enumerate(reductions)]
        return Advice(0.1, 1.0, tuple(tests)).sentence

    narrowed = "it would narrow the spread of the stress from 10.0 % to 6.00 %."
    assert ranked(0.4, 0.2) == f"The next test worth doing is t0: {narrowed}"
    assert ranked(0.4, 0.38, 0.1).endswith("As good, as far as can be told: t1.")
    assert ranked(0.03, 0.01).startswith("No further test of these is worth doing: the best, t0, would only")
