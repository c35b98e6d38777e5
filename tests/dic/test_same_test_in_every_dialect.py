"""One test of a heterogeneous sheet, written by every software, is one series to the digits that were written."""

import numpy as np
import pytest

from hypernode.dic.reading import read_series
from tests.dic.exports import ASSEMBLED, FRAMES, MM, PIXELS, Sheet, export

COLUMNS, ROWS, LOST = 12, 10, 43
#: Length of a pixel [mm], with which exports in pixels are of the same sheet as those in mm.
PIXEL_SIZE = MM / PIXELS
#: Significant digits of exports in pixels, and of those in mm.
PIXEL_DIGITS, MM_DIGITS = 7, 15


def heterogeneous(k, a, b):
    """Displacement of frame k at steps a to the right and b upward, all in steps."""
    u = k * (0.04 - 0.006 * a + 0.02 * np.sin(0.3 * a + 0.7 * b)) + 0.003 * k**2 * b
    v = k * (0.05 + 0.02 * b + 0.03 * np.sin(0.5 * a) * np.cos(0.4 * b))
    return u, v


def sheet(step, digits):
    def displacement(k, X, Y):
        return tuple(step * component for component in heterogeneous(k, X / step, Y / step))

    return Sheet(columns=COLUMNS, rows=ROWS, displacement=displacement, lost=LOST, digits=digits)


@pytest.mark.parametrize("case", [*FRAMES, *ASSEMBLED])
def test_the_same_test_is_the_same_series(tmp_path, case):
    in_pixels = (FRAMES[case][0] if case in FRAMES else ASSEMBLED[case][1]) == PIXELS
    step, digits = (PIXELS, PIXEL_DIGITS) if in_pixels else (MM, MM_DIGITS)
    export(tmp_path, case, sheet(step, digits))
    series = read_series(tmp_path)
    mm = series.millimetres(PIXEL_SIZE)
    a, b = np.meshgrid(np.arange(COLUMNS), np.arange(ROWS))
    expected = MM * np.stack([np.stack(heterogeneous(k, a, b), axis=-1) for k in range(3)])
    expected[1:, ROWS - 1 - LOST // COLUMNS, LOST % COLUMNS] = np.nan
    largest = np.nanmax(np.abs(expected)) / mm
    half_a_digit = 0.5 * 10.0 ** (np.floor(np.log10(largest)) + 1 - digits)
    near = {"rtol": 1e-9, "atol": mm * half_a_digit if in_pixels else 1e-9 * MM}
    np.testing.assert_allclose(mm * series.x, MM * np.arange(COLUMNS), **near)
    np.testing.assert_allclose(mm * series.y, MM * np.arange(ROWS), **near)
    np.testing.assert_allclose(mm * np.stack([f.displacement for f in series.frames]), expected, **near)
