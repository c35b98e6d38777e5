"""What a measurement says of its forces."""

import numpy as np
import xarray as xr

from hypernode.data.measurement import force_uncertainty


def measurement(**variables):
    return xr.Dataset({"stretch": ("load_step", [1.1, 1.2]), **variables}, attrs={"force_uncertainty": 0.03})


def test_a_force_is_as_uncertain_as_it_is_stated_to_be_and_by_its_picture_besides():
    np.testing.assert_allclose(force_uncertainty(measurement()), [0.03, 0.03])
    paired = measurement(force_pairing_uncertainty=("load_step", [0.04, 0.0]))
    np.testing.assert_allclose(force_uncertainty(paired), [0.05, 0.03])
