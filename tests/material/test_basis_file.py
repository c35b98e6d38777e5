"""Fields of a convex basis in files."""

import numpy as np
import xarray as xr

from hypernode.material.basis_file import basis_content, basis_field
from hypernode.mechanics.convex_basis import ConvexBasis

BASIS = ConvexBasis(("I1_squared", "I2"), 0.2)
PARTS = np.random.default_rng(1).normal(size=(len(BASIS.names), 2, 5))


def test_a_field_is_read_as_it_was_written():
    variables, attributes = basis_content(BASIS, PARTS)
    basis, found = basis_field(xr.Dataset(variables, attrs=attributes))
    assert basis == BASIS
    np.testing.assert_array_equal(found, PARTS)
