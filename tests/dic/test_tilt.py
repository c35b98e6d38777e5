"""A tilted grid is seen in its own axes, where its points are on lines; nothing else is turned."""

from pathlib import Path

import numpy as np
import pytest

from hypernode.dic.grid import NearGrid, grid_of
from hypernode.dic.points import Points
from hypernode.dic.reading import read_series
from hypernode.dic.tilt import tilt_of
from tests.dic.exports import COLUMNS, FRAMES, ROWS, turned, write


def lattice(columns=30, rows=20, steps=(0.5, 0.5), tilt=0.0, keep=lambda x, y: np.ones(x.shape, dtype=bool)):
    """Points of a tilted grid, those that are kept in its own axes."""
    x, y = (a.ravel() for a in np.meshgrid(steps[0] * np.arange(columns), steps[1] * np.arange(rows)))
    chosen = keep(x, y)
    return at(np.stack(turned(x[chosen], y[chosen], tilt), axis=1))


def at(position):
    return Points(
        path=Path("f0000.csv"),
        position=position,
        displacement=np.zeros_like(position),
        line=np.arange(len(position)) + 2,
        unit="mm",
    )


@pytest.mark.parametrize("case", FRAMES)
def test_a_tilted_copy_of_an_export_gives_the_same_series(tmp_path, case, capsys):
    straight, *copies = (tmp_path / f"{degrees}" for degrees in (0, 1, 10, 30, 44, 45, -20))
    straight.mkdir()
    write(straight, case)
    expected = read_series(straight)
    assert expected.tilt == 0.0 and "tilted by" not in capsys.readouterr().err
    size = max(expected.x[-1], expected.y[-1])
    for folder in copies:
        folder.mkdir()
        write(folder, case, tilt=float(folder.name))
        series = read_series(folder)
        assert series.tilt == pytest.approx(float(folder.name), abs=1e-9)
        assert f"tilted by {folder.name} degrees" in capsys.readouterr().err
        np.testing.assert_allclose(series.x, expected.x, atol=1e-9 * size)
        np.testing.assert_allclose(series.y, expected.y, atol=1e-9 * size)
        for frame, other in zip(series.frames, expected.frames, strict=True):
            largest = np.nanmax(np.abs(expected.frames[-1].displacement))
            np.testing.assert_allclose(frame.displacement, other.displacement, rtol=0, atol=1e-9 * largest)
            assert (frame.number, frame.time, frame.force) == (other.number, other.time, other.force)


def test_a_quarter_turn_is_no_tilt_and_minus_45_degrees_are_45(tmp_path):
    assert tilt_of(lattice(tilt=90.0)) is None
    write(tmp_path, "table", tilt=-45.0)
    series = read_series(tmp_path)
    assert series.tilt == pytest.approx(45.0, abs=1e-9)
    assert series.frames[1].displacement.shape == (COLUMNS, ROWS, 2)


@pytest.mark.parametrize("degrees", [1e-5, 0.003, -0.2, 7.0, 44.999])
@pytest.mark.parametrize("steps", [(0.5, 0.5), (0.5, 1.3), (1.3, 0.5)])
def test_any_tilt_is_found_to_rounding(degrees, steps):
    tilt = tilt_of(lattice(steps=steps, tilt=degrees))
    np.testing.assert_allclose(tilt.degrees, degrees, rtol=0, atol=1e-12)
    np.testing.assert_allclose(np.diff(tilt.grid.x), steps[0], rtol=1e-12)
    np.testing.assert_allclose(np.diff(tilt.grid.y), steps[1], rtol=1e-12)


@pytest.mark.parametrize("degrees", [1.0, 30.0, 45.0])
def test_lost_points_of_a_tilted_grid_are_lost_and_nothing_else(degrees):
    random = np.random.default_rng(3)

    def keep(x, y):
        return (np.hypot(x - 7.0, y - 5.0) > 2.0) & (random.uniform(size=x.shape) > 0.2)

    points = lattice(tilt=degrees, keep=keep)
    tilt = tilt_of(points)
    u = tilt.grid.values(tilt.seen(points), 0)
    assert u.shape == (20, 30, 2) and np.isfinite(u[..., 0]).sum() == len(points.position)


def test_an_untilted_grid_with_lost_points_is_not_turned():
    random = np.random.default_rng(4)
    for share in (0.0, 0.3, 0.6):
        assert tilt_of(lattice(keep=lambda x, y, share=share: random.uniform(size=x.shape) >= share)) is None


def test_a_tilted_grid_written_with_few_digits_lies_on_lines():
    points = lattice(tilt=10.0)
    tilt = tilt_of(at(points.position.round(3)))
    # Three standard deviations of a slope through points that rounding moves evenly within a digit.
    deviation = 1e-3 / np.sqrt(12) / np.sqrt(np.square(points.position - points.position.mean(axis=0)).sum())
    assert tilt.angle == pytest.approx(np.radians(10.0), abs=3 * deviation)
    assert tilt.grid.values(tilt.seen(points), 0).shape == (20, 30, 2)


@pytest.mark.parametrize("irregular", [0.001, 0.01, 0.1])
def test_irregular_and_sheared_points_stay_near_a_grid_along_the_axes(irregular):
    random = np.random.default_rng(5)
    for _ in range(20):
        straight = lattice()
        x, y = straight.position.T
        moved = at(straight.position + 0.5 * irregular * random.uniform(-1, 1, straight.position.shape))
        for points in (moved, at(np.stack([x + irregular * y, y], axis=1))):
            assert tilt_of(points) is None and isinstance(grid_of(points), NearGrid)


def test_scattered_points_are_not_turned():
    random = np.random.default_rng(6)
    for _ in range(20):
        points = at(random.uniform(0, [15.0, 10.0], (600, 2)))
        assert tilt_of(points) is None and isinstance(grid_of(points), NearGrid)


def test_a_grid_within_a_sheet_along_the_axes_of_the_files_is_not_turned():
    points = lattice(60, 60, tilt=10.0)
    centre = points.position.mean(axis=0)
    inside = (np.abs(points.position - centre) <= [9.0, 6.0]).all(axis=1)
    assert tilt_of(points) is not None and tilt_of(at(points.position[inside])) is None
