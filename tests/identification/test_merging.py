"""Materials are tried as one where data hardly tell them apart, and the better known one stands for both."""

from types import SimpleNamespace

import numpy as np
import pytest

from hypernode.fem.mesh import rectilinear
from hypernode.fem.refinement import refine
from hypernode.identification import thresholds
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.lines import Lines
from hypernode.identification.merging import _without_least_known, merged
from hypernode.mechanics.convex_basis import FIBRE_VECTOR

GRID = rectilinear(np.linspace(0.0, 1.0, 7), np.linspace(0.0, 1.0, 7))
LABELS = (GRID.centres[:, 0] > 0.35).astype(int) + (GRID.centres[:, 0] > 0.7)


def candidate(materials, errors, names=("log_level", "log1p_I2")):
    lines = Lines.of(GRID, refine(GRID, 1))
    field = Interfaces.around(lines, np.array(materials), LABELS)
    covariance = np.diag(np.square(errors).ravel())
    return SimpleNamespace(
        fit=SimpleNamespace(field=field, covariance=covariance),
        problem=SimpleNamespace(basis=SimpleNamespace(names=names)),
    )


def test_the_two_that_are_least_known_to_differ_become_one_with_the_parameters_of_the_better_known():
    kept = candidate([[0.0, 0.1], [1.0, 0.2], [1.1, 3.0]], [[0.01, 0.01], [0.02, 0.02], [0.3, 2.0]])
    found = _without_least_known(kept)
    assert found.count == 2
    np.testing.assert_allclose(found.materials, [[0.0, 0.1], [1.0, 0.2]])


@pytest.mark.parametrize(("share", "tried"), [(0.9, True), (1.1, False)])
def test_materials_that_differ_beyond_doubt_are_not_tried(share, tried):
    apart = share * thresholds.APART * np.sqrt(2.0) * 0.01
    kept = candidate([[0.0, 0.0], [apart, 0.0], [5.0, 0.0]], [[0.01, 0.01]] * 3)
    assert (_without_least_known(kept) is not None) is tried


def test_a_fibre_and_its_opposite_are_the_same():
    names = ("log_level", *FIBRE_VECTOR)
    kept = candidate([[0.0, 0.3, 0.4], [0.0, -0.3, -0.4], [0.0, 0.4, -0.3]], [[0.01] * 3] * 3, names)
    assert _without_least_known(kept) is not None


def test_what_was_tried_and_refused_is_not_tried_again():
    kept = candidate([[0.0, 0.1], [1.0, 0.2], [1.1, 3.0]], [[0.01, 0.01], [0.02, 0.02], [0.3, 2.0]])
    # Trials without a descent: another one would be an error.
    trials = SimpleNamespace(was_tried=lambda move, start: move == "two materials as one" and start is kept)
    assert merged(trials, kept, [0], False) is kept
