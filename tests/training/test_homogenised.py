"""The material of the whole sheet, from which networks begin, has the terms of the field that they will learn."""

import numpy as np
import pytest

from hypernode.config.methods import Method
from hypernode.config.presets import presets
from hypernode.data.loading import Loading
from hypernode.fem.mesh import rectilinear
from hypernode.networks.terms import POWERS
from hypernode.training.homogenised import fit_homogenised, terms_for


@pytest.mark.parametrize(
    ("field", "further"), [(("I1_squared", "I2", "fibre"), ()), (("I2", "ogden"), POWERS), ((), ())]
)
def test_powers_of_stretches_join_where_the_field_has_them(field, further):
    method, node = fitted(field)
    assert node.terms == (*method.node.terms, *further)


def test_networks_of_a_field_that_changes_its_volume_have_no_thickness():
    method, node = fitted(("J", "I1_squared"))
    assert node.terms == ("I1", "I1_I4v", "I1_I4w", "I4v_I4w", "J")
    assert "I2" in method.node.terms
    own = method.node.model_copy(update={"terms": ["I1", "J"]})
    assert terms_for(own, ("J",)) == ("I1", "J")


def fitted(field):
    """(the default method, the material of its networks for a field with these terms)."""
    method = Method.model_validate(presets()["hypernode"])
    method = method.model_copy(update={"homogenised": method.homogenised.model_copy(update={"iterations": 2})})
    mesh = rectilinear(np.linspace(0.0, 1.0, 3), np.linspace(0.0, 1.0, 3))
    F = np.broadcast_to(np.diag([1.1, 1.1])[:, :, None, None], (2, 2, 1, 4))
    none = np.zeros((1, 4, 2), dtype=bool)
    P = np.eye(2)[None]
    known = np.ones((1, 2, 2), dtype=bool)
    loading = Loading(
        load_case=np.zeros(1, int),
        t=np.ones(1),
        resultant=np.ones((1, 2)),
        P_average=P,
        measured=known,
        scale=np.ones(1),
        constrained=none,
        known=none,
    )
    return method, fit_homogenised(method, "sheet", mesh, loading, F, field).node
