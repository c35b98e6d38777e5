"""Arrays come back from their text within half a step, and what is few or whole as it was."""

import numpy as np
import pytest

from hypernode.explorer.packing import Arrays, restored
from tests.explorer.decoding import decoded


@pytest.mark.parametrize("bits", [8, 12, 16])
def test_numbers_come_back_within_half_a_step_of_their_row(bits):
    values = np.random.default_rng(0).normal(0.0, [[1.0], [100.0]], (2, 500))
    values[0, 3] = np.nan
    arrays = Arrays()
    arrays.add(np.arange(7.0))
    entry = arrays.add(values, bits)
    found = decoded(entry, arrays)
    step = (np.nanmax(values, axis=1) - np.nanmin(values, axis=1)) / (2**bits - 2)
    assert np.array_equal(np.isnan(found), np.isnan(values))
    assert (np.nanmax(np.abs(found - values), axis=1) <= 0.51 * step).all()
    assert np.array_equal(found, restored(values, bits), equal_nan=True)


def test_few_different_values_and_whole_numbers_are_kept_exactly():
    arrays = Arrays()
    few = np.random.default_rng(1).choice([0.1, 1 / 3, 2e5], (3, 2, 300))
    whole = np.random.default_rng(2).permutation(70000).astype(float)
    entries = arrays.add(few), arrays.add(whole, 24)
    assert np.array_equal(decoded(entries[0], arrays), few)
    assert np.array_equal(decoded(entries[1], arrays), whole)


def test_a_row_without_any_number_stays_without():
    arrays = Arrays()
    entry = arrays.add(np.full((1, 3), np.nan))
    assert np.isnan(decoded(entry, arrays)).all()
