"""Points that are no exact grid, and sheets that are no plane along the axes."""

import numpy as np
import pytest

from hypernode.dic.declared import Declared
from hypernode.dic.errors import DicError
from hypernode.dic.reading import read_series
from tests.dic.exports import STEREO, displacement


def scattered(folder, place, w=lambda k, x, y: None):
    """Two frames of a declared or a stereo table at any points."""
    X, Y = (a.ravel() for a in np.meshgrid(0.5 * np.arange(12), 0.5 * np.arange(10)))
    x, y = place(X, Y)
    for k in range(2):
        u, v = displacement(k, x, y)
        out = w(k, x, y)
        columns = [x, y, u, v] if out is None else [x, y, np.zeros_like(x), u, v, out, x]
        header = "x [mm],y [mm],u [mm],v [mm]" if out is None else STEREO
        delimiter = "," if out is None else ";"
        rows = [delimiter.join(f"{value:.12g}" for value in row) for row in zip(*columns, strict=True)]
        (folder / f"f{k:04d}.csv").write_text("\n".join([header, *rows]))


def test_points_near_a_grid_are_interpolated_onto_one_and_the_log_says_how_far(tmp_path, capsys):
    random = np.random.default_rng(1)
    scattered(
        tmp_path, lambda X, Y: (X + 0.05 * random.uniform(-1, 1, X.shape), Y + 0.05 * random.uniform(-1, 1, X.shape))
    )
    series = read_series(tmp_path)
    u = series.frames[1].displacement
    assert (len(series.x), len(series.y)) == (12, 10) and np.isfinite(u[1:-1, 1:-1]).all()
    # The displacement is linear: its interpolation is exact, up to a constant from the shift of the origin.
    np.testing.assert_allclose(np.diff(u[1:-1, 1:-1, 0], axis=1), 0.03 * (series.x[1] - series.x[0]), rtol=1e-6)
    assert "of a step away" in capsys.readouterr().err


def test_a_grid_turned_against_the_axes_is_not_extrapolated(tmp_path):
    c, s = np.cos(0.2), np.sin(0.2)
    # Too irregular to be turned back.
    dx, dy = 0.05 * np.random.default_rng(1).uniform(-1, 1, (2, 120))
    scattered(tmp_path, lambda X, Y: (c * X - s * Y + dx, s * X + c * Y + dy))
    u = read_series(tmp_path).frames[1].displacement
    assert np.isnan(u[0, 0]).all() and np.isnan(u[-1, -1]).all() and np.isfinite(u[5, 5]).all()


def test_a_hole_among_scattered_points_is_lost(tmp_path):
    def place(X, Y):
        far = np.hypot(X - 2.75, Y - 2.25) > 1.2
        return X[far] + 0.03 * Y[far], Y[far]

    scattered(tmp_path, place)
    series = read_series(tmp_path)
    column = np.argmin(np.abs(series.x - 2.8))
    assert np.isnan(series.frames[1].displacement[4:6, column]).all()
    assert np.isfinite(series.frames[1].displacement[1, 4:8]).all()


def test_points_twice_in_a_scattered_frame_are_refused(tmp_path):
    scattered(tmp_path, lambda X, Y: (X + 0.03 * Y, Y))
    path = tmp_path / "f0001.csv"
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines, lines[4]]))
    with pytest.raises(DicError, match=r"f0001\.csv:122: the point .* there twice"):
        read_series(tmp_path)


def test_a_sheet_that_leaves_its_plane_is_refused_unless_allowed(tmp_path):
    scattered(tmp_path, lambda X, Y: (X, Y), lambda k, x, y: k * 0.1 * x)
    with pytest.raises(DicError, match="allow_out_of_plane"):
        read_series(tmp_path)
    assert 0.09 < read_series(tmp_path, declared=Declared(allow_out_of_plane=True)).out_of_plane <= 0.1


def test_a_tilted_sheet_is_seen_in_its_own_plane(tmp_path):
    X, Y = (a.ravel() for a in np.meshgrid(0.5 * np.arange(12), 0.5 * np.arange(10)))
    c, s = np.cos(0.3), np.sin(0.3)
    for k in range(2):
        # Stretched by 2 % along a direction that leans out of the x-y plane.
        columns = [c * X, Y, s * X, 0.02 * k * c * X, 0 * X + 1e-9 * k, 0.02 * k * s * X, X]
        rows = [";".join(f"{value:.12g}" for value in row) for row in zip(*columns, strict=True)]
        (tmp_path / f"B{k:04d}.csv").write_text("\n".join([STEREO, *rows]))
    series = read_series(tmp_path)
    np.testing.assert_allclose(np.diff(series.x), 0.5, rtol=1e-6)
    np.testing.assert_allclose(np.diff(series.frames[1].displacement[3, :, 0]), 0.01, rtol=1e-4)
    assert series.out_of_plane < 1e-6
