"""Points of a reference that no sheet has: refused with one sentence, before a grid is laid over all of space."""

import numpy as np
import pytest

from hypernode.dic.reading import read_series
from tests.dic.refusals import refused

LINES = 0.5 * np.arange(12)
GRID = np.stack(np.meshgrid(LINES, LINES), axis=-1).reshape(-1, 2)
SCATTERED = GRID + 0.1 * np.random.default_rng(0).uniform(-1.0, 1.0, GRID.shape)


def reference(folder, points):
    for k in range(2):
        rows = [f"{x!r},{y!r},{0.01 * k * x!r},{0.01 * k * y!r}" for x, y in points.tolist()]
        (folder / f"f{k}.csv").write_text("\n".join(["x [mm],y [mm],u [mm],v [mm]", *rows, ""]))
    return folder / "f0.csv"


@pytest.mark.parametrize("points", [GRID, SCATTERED])
def test_a_decimal_sign_that_is_lost_is_named_with_its_line(tmp_path, points):
    wrong = points.copy()
    wrong[30, 0] *= 10.0
    with refused(reference(tmp_path, wrong), r"f0\.csv:32: the point \[(30|29).* lies 2\d.* mm from every other"):
        read_series(tmp_path)


def test_two_sheets_far_apart_are_no_grid(tmp_path):
    with refused(reference(tmp_path, np.concatenate([SCATTERED, SCATTERED + 1e5])), "scattered too widely", line=False):
        read_series(tmp_path)


def test_points_on_a_line_are_no_grid(tmp_path):
    along = np.linspace(0.0, 10.0, 40)
    with refused(reference(tmp_path, np.stack([along, 0.5 * along], axis=1)), "on a line: no grid", line=False):
        read_series(tmp_path)
