"""Fields of a convex basis in files."""

import numpy as np
import xarray as xr

from hypernode.material.basis_file import basis_content, basis_field, field_of_cells, mixture_content
from hypernode.mechanics.convex_basis import ConvexBasis

BASIS = ConvexBasis(("I1_squared", "I2"), 0.2)
PARTS = np.random.default_rng(1).normal(size=(len(BASIS.names), 2, 5))
MIXTURES = np.random.default_rng(2).normal(size=(5, len(BASIS.names)))


def test_a_field_is_read_as_it_was_written():
    variables, attributes = basis_content(BASIS, PARTS)
    basis, found = basis_field(xr.Dataset(variables, attrs=attributes))
    assert basis == BASIS
    np.testing.assert_array_equal(found, PARTS)


def test_the_field_of_cells_is_that_of_mixtures_where_parts_are_layers_and_the_field_itself_elsewhere():
    variables, attributes = basis_content(BASIS, PARTS)
    _, found = field_of_cells(xr.Dataset(variables, attrs=attributes))
    np.testing.assert_array_equal(found, PARTS)
    variables |= mixture_content(BASIS, MIXTURES)
    _, found = field_of_cells(xr.Dataset(variables, attrs=attributes))
    np.testing.assert_array_equal(found, MIXTURES.T[:, None])
