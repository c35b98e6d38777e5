"""Columns of displacements that are swapped or point the other way are asked about, and a key turns them."""

import numpy as np
import pytest

from hypernode.dic.forces.growth import check_bend
from hypernode.inspection.folder import inspect
from tests.dic.pulls import LINES, NOISE, STEP, fields, write
from tests.inspection.test_situations import SIZE, force_at, record, said_of

GIVEN = {**SIZE, "frame_rate": 1.0}


def turned(axes):
    """Frames of a clamped pull whose two columns point along these axes."""
    ways = [(-1.0 if axis.startswith("-") else 1.0) * np.eye(2)["xy".index(axis[-1])] for axis in axes]
    return [u @ np.stack(ways, axis=1) for u in fields()]


@pytest.mark.parametrize("axes", [("y", "x"), ("x", "-y"), ("-x", "y"), ("-y", "-x")])
def test_a_pull_whose_columns_point_elsewhere_is_refused_and_right_once_they_are_named(tmp_path, axes):
    folder = write(tmp_path / "pull", turned(axes))
    record(folder)
    found = inspect(folder, GIVEN)
    assert found.sheet is None and "displacement_axes" in said_of(found)
    found = inspect(folder, {**GIVEN, "displacement_axes": list(axes)})
    case = found.sheet.cases[0]
    assert not said_of(found)
    np.testing.assert_allclose(case.stretch, 1.0 + STEP * case.numbers, atol=1e-3)
    np.testing.assert_allclose(case.force[1, 1], force_at(STEP * case.numbers), rtol=2e-3)


def sheared(turn, steps=range(9)):
    """Frames whose top moves along x, in which the sides between the ends turn by a share of that."""
    y, x = np.meshgrid(LINES, LINES, indexing="ij")
    middle = 4.0 * (y / 12.0) * (1.0 - y / 12.0)
    rng = np.random.default_rng(2)
    return [
        np.stack([STEP * k * y, turn * STEP * k * middle * (x - 6.0)], axis=-1)
        + (k > 0) * rng.normal(0.0, NOISE, (13, 13, 2))
        for k in steps
    ]


def test_a_broad_sheet_that_is_sheared_is_not_asked_about(tmp_path):
    folder = write(tmp_path / "shear", sheared(-0.04))
    record(folder)
    assert not said_of(inspect(folder, GIVEN))


def test_a_shear_that_looks_like_a_swapped_pull_is_taken_where_it_is_said(tmp_path):
    folder = write(tmp_path / "shear", sheared(-0.4))
    record(folder)
    found = inspect(folder, GIVEN)
    assert found.sheet is None and "--load shear says that they are right" in said_of(found)
    assert not said_of(inspect(folder, {**GIVEN, "load": "shear"}))


def biaxial(folder, factor, crossheads):
    """A sheet pulled along both axes, its displacements times a factor, and a record of both forces."""
    y, x = np.meshgrid(LINES, LINES, indexing="ij")
    rng = np.random.default_rng(6)
    frames = [
        factor * (0.025 * k * np.stack([x, y], axis=-1) + (k > 0) * rng.normal(0.0, NOISE, (13, 13, 2)))
        for k in range(9)
    ]
    write(folder, frames)
    time = np.arange(0.0, 8.05, 0.1)
    stretch = 1.0 + 0.025 * time
    force = 3.0 * (stretch - stretch**-5.0)
    ways = [12.0 * (stretch - 1.0)] * (2 * crossheads)
    rows = [",".join(f"{each:.6f}" for each in row) for row in zip(time, force, force, *ways, strict=True)]
    names = "Time,Force x,Force y" + ",Displacement x,Displacement y" * crossheads
    (folder / "force_disp.csv").write_text("\n".join([names, "s,N,N" + ",mm,mm" * crossheads, *rows]) + "\n")
    return folder


@pytest.mark.parametrize("crossheads", [False, True])
def test_displacements_a_tenth_of_the_true_ones_are_said_of_a_sheet_that_is_pulled_along_both_axes(
    tmp_path, crossheads
):
    folder = biaxial(tmp_path / "pull", 0.1, crossheads)
    assert "--set displacement_factor=10" in said_of(inspect(folder, GIVEN))
    assert not said_of(inspect(folder, {**GIVEN, "displacement_factor": 10.0}))
    assert not said_of(inspect(biaxial(tmp_path / "right", 1.0, crossheads), GIVEN))


@pytest.mark.parametrize("power", [-5.0, -2.0, 1.0, 5.0, 9.0])
@pytest.mark.parametrize("reach", [0.02, 0.1])
def test_no_power_of_stretches_softens_as_displacements_of_a_tenth_do(power, reach):
    e = np.linspace(0.0, reach, 12)
    force = (1.0 + e) ** (power - 1.0) - (1.0 + e) ** (-2.0 * power - 1.0)
    assert not check_bend(1.0 + e, force * np.sign(power))


@pytest.mark.parametrize("reach", [0.1, 0.5])
def test_rubber_whose_displacements_are_a_tenth_bends_as_no_sheet_does(reach):
    e = np.linspace(0.0, reach, 12)
    force = 1.0 + e - (1.0 + e) ** -5.0
    assert not check_bend(1.0 + e, force)
    assert check_bend(1.0 + 0.1 * e, force)
