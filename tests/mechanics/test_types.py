"""Annotations are promises: with the option of `make types`, a call that breaks one is refused."""

import numpy as np
import pytest
from jaxtyping import TypeCheckError

from hypernode.fem.mesh import rectilinear
from hypernode.mechanics.kinematics import invariants


@pytest.fixture(autouse=True)
def checked(request):
    if not request.config.getoption("jaxtyping_packages"):
        pytest.skip("annotations are checked with --jaxtyping-packages, by make types")


def test_a_gradient_of_three_dimensions_is_refused():
    with pytest.raises(TypeCheckError, match="F"):
        invariants(np.ones((3, 3)), 0.0)


def test_lines_of_two_dimensions_are_refused():
    with pytest.raises(TypeCheckError, match="x"):
        rectilinear(np.zeros((2, 2)), np.arange(3.0))
