"""The further test that is advised against one drawn at random, on small sheets that are really identified with both.

    python benchmarks/next_test.py [SHEETS [FIRST]]

Each sheet has a stiff square, ellipse or band somewhere, one of three laws and one of three first tests. It is
identified with its first test and with each further one beside it; what counts is the error of its stress against the
known one, over cells and probe modes, and the posterior spread. A random test is any of those that are compared: the
mean over all of them stands for it.
"""

import json
import sys
import time
from pathlib import Path

from hypernode.pipeline.compiler import set_up_compiler

# Sheets of one law share what is compiled.
set_up_compiler(float64=True)
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np

from hypernode.advice.candidates import standard_loads
from hypernode.advice.further_test import advise
from hypernode.config.methods import Constrained
from hypernode.identification.gauss_newton import descend
from hypernode.identification.problem import field_problem
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.mechanics.modes import mode_gradients
from hypernode.progress import heard
from tests.advice.test_advice import together
from tests.sheets import SCALE, sheet

CELLS, NOISE, AMOUNTS = 8, 1e-3, (0.1, 0.2)
STRETCHES = 1.0 + np.array(AMOUNTS)
LAWS = (
    (("I1_squared",), {"log1p_I1_squared": 0.5}),
    (("I2",), {"log1p_I2": 0.5}),
    (("fibre",), {"fibre_x": 0.5, "fibre_y": 0.3}),
)
FIRST = ("uniaxial x", "uniaxial y", "shear")


def inclusion(random):
    """Where a sheet is stiff: an ellipse or a rectangle, as wide or narrow as it comes."""
    centre, half, round_ = random.uniform(0.3, 0.7, 2), random.uniform(0.15, 0.4, 2), random.uniform() < 0.5

    def inside(X):
        distance = np.abs(X - centre) / half
        return (np.hypot(*distance.T) < 1.0) if round_ else (distance < 1.0).all(axis=1)

    return inside


def identified(data, settings):
    """The field of one descent."""
    with heard():
        return descend(field_problem(data, settings), settings, "sheet", None, (), settings.tolerance)


def stress(basis, params):
    """Stress of every cell in every probe mode."""
    F = np.moveaxis(mode_gradients(STRETCHES).reshape(-1, 2, 2), 0, -1)
    return np.stack([np.asarray(basis.stress(F, each[:, None])) for each in params])


def compared(number: int):
    """(name of the advised test, {name: relative error of the stress with it}, that with the first test alone)."""
    random = np.random.default_rng(number)
    terms, values = LAWS[number % len(LAWS)]
    shape, loads = inclusion(random), {each.name: each.load for each in standard_loads(AMOUNTS)}
    first = FIRST[(number // len(LAWS)) % len(FIRST)]

    def measured(name, seed):
        data, _, true = sheet(CELLS, shape, loads[name], NOISE, terms=terms, seed=seed, values=values.items())
        return data.assign_attrs(load_cases=json.dumps([name])), true

    data, true = measured(first, 100 * number)
    settings = Constrained(terms=list(terms), iterations=20)
    found = identified(data, settings)
    tests = [each for each in standard_loads(AMOUNTS) if each.name != first]
    with heard():
        guesses = [state.u for state in found.states]
        advice = advise(found.problem, found.params, guesses, data, settings, tests, STRETCHES, "sheet")
    wanted = stress(ConvexBasis(terms, SCALE), true)

    def error(field):
        return float(np.linalg.norm(stress(field.problem.basis, field.params) - wanted) / np.linalg.norm(wanted))

    errors = {}
    for k, test in enumerate(tests, 1):
        pair = together(data, measured(test.name, 100 * number + k)[0])
        errors[test.name] = error(identified(pair, settings))
    return first, [each.name for each in advice.tests], errors, error(found)


def main(sheets: int, start: int = 0) -> None:
    """Print a line a sheet and what they come to."""
    begin, advised, drawn, best, alone, ranks = time.monotonic(), [], [], [], [], []
    for number in range(start, start + sheets):
        first, ranking, errors, before = compared(number)
        alone.append(before)
        advised.append(errors[ranking[0]])
        drawn.append(np.mean(list(errors.values())))
        best.append(min(errors.values()))
        ranks.append(1 + sorted(errors, key=errors.get).index(ranking[0]))
        each = ", ".join(f"{name} {errors[name]:.4f}" for name in ranking)
        print(f"{number}: {first} alone {before:.4f}; as advised: {each}; {time.monotonic() - begin:.0f} s", flush=True)
    for name, values in (("first alone", alone), ("advised", advised), ("random", drawn), ("best", best)):
        print(f"{name}: mean error of the stress {np.mean(values):.4f}, median {np.median(values):.4f}")
    better = np.mean(np.array(advised) < np.array(drawn))
    print(
        f"advised better than random on {better:.0%}; its rank among {len(errors)} by error, mean {np.mean(ranks):.1f}"
    )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:] or [10]))
