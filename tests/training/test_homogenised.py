"""The material of the whole sheet, from which networks begin, has the terms of the field that they will learn."""

import numpy as np
import pytest

from hypernode.config.methods import Method
from hypernode.config.presets import presets
from hypernode.data.loading import Loading
from hypernode.fem.mesh import rectilinear
from hypernode.networks.terms import POWERS
from hypernode.training.homogenised import fit_homogenised


@pytest.mark.parametrize(
    ("field", "further"), [(("I1_squared", "I2", "fibre"), ()), (("I2", "ogden"), POWERS), ((), ())]
)
def test_powers_of_stretches_join_where_the_field_has_them(field, further):
    method = Method.model_validate(presets()["hypernode"])
    method = method.model_copy(update={"homogenised": method.homogenised.model_copy(update={"iterations": 2})})
    mesh = rectilinear(np.linspace(0.0, 1.0, 3), np.linspace(0.0, 1.0, 3))
    F = np.broadcast_to(np.diag([1.1, 1.1])[:, :, None, None], (2, 2, 1, 4))
    none = np.zeros((1, 4, 2), dtype=bool)
    P = np.eye(2)[None]
    known = np.ones((1, 2, 2), dtype=bool)
    loading = Loading(np.zeros(1, int), np.ones(1), np.ones((1, 2)), P, known, np.ones(1), none, none)
    node = fit_homogenised(method, "sheet", mesh, loading, F, field).node
    assert node.terms == (*method.node.terms, *further)
