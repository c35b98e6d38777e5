"""A photographed sheet becomes a measurement as a real one does: cut out, with a share of the force, and its truth."""

import json
from dataclasses import replace

import numpy as np
import pytest

from hypernode.config.loading import check_config
from hypernode.data.information import information_of
from hypernode.data.measurement import mesh_of
from hypernode.dic.errors import DicError
from hypernode.fem.interpolation import NodalField
from hypernode.fem.mesh import EDGE_NAMES, rectilinear
from hypernode.pictures.correlation import Correlated, EngineMissing, python_of
from hypernode.stages import correlate, photograph, photographed, speckle
from hypernode.storage.netcdf import SYNTHETIC_UNITS, read, write

#: A sheet of 1.2 x 1 in 120 x 100 pixels, whose middle is stretched less than the rest.
MESH = rectilinear(np.linspace(0.0, 1.2, 25), np.linspace(0.0, 1.0, 21))
STRETCHES = [1.04, 1.1]
PULL = np.array([2.0, 3.0])
RAW = {
    "geometries": {"whole": {"shape": "uniform"}},
    "materials": {"soft": {"model": "neo_hookean", "mu": 1.0}},
    "loads": {"pull": {"kind": "equibiaxial", "stretches": STRETCHES}},
    "noise": {"cell": {"force_gain": 0.1, "seed": 1}},
    "cases": {
        "s": {
            "geometry": "whole", "matrix": "soft", "loads": ["pull"], "cells": [24, 20], "size": [1.2, 1.0],
            "camera": {
                "pictures": {"pixels": 120, "margin": 10, "noise": 1.0},
                "correlation": {"subset": 15, "step": 4, "reach": 20},
            },
        }
    },
}  # fmt: skip


def displacement(X, stretch):
    soft = 0.01 * np.sin(np.pi * X / MESH.upper)
    return (stretch - 1.0) * (X + soft * X[:, ::-1])


def forward_file(folder):
    u = np.stack([displacement(MESH.nodes, stretch) for stretch in STRETCHES])
    force, held = np.full((2, 4, 2), np.nan), np.zeros((2, 4, 2))
    for axis, (low, high) in enumerate((("left", "right"), ("bottom", "top"))):
        for edge, sign in ((low, -1.0), (high, 1.0)):
            force[:, EDGE_NAMES.index(edge), axis] = sign * PULL
            held[:, EDGE_NAMES.index(edge), axis] = 1.0
    path = folder / "forward.nc"
    write(
        path,
        {
            "X": MESH.nodes, "cells": MESH.cells, "corners": np.stack([MESH.lower, MESH.upper]), "u": u,
            "load_case": [0, 0], "stretch": STRETCHES, "edge_force": force, "edge_constrained": held,
        },
        "forward",
        {"units": SYNTHETIC_UNITS, "load_cases": ["pull"], "thickness": 1.0},
    )  # fmt: skip
    return path


def seen(forward):
    """Displacements from that of the middle, which is a node."""
    u = forward["u"].values
    middle = np.isclose(forward["X"].values, [0.6, 0.5]).all(axis=1)
    assert middle.sum() == 1
    return u - u[:, middle]


def exact_points(forward, lost=()):
    """Points every 4 pixels of a sheet whose lower left corner is at (9.5, 129.5), without errors of correlation."""
    column, row = (each.ravel() for each in np.meshgrid(np.arange(12, 130, 4), np.arange(32, 130, 4)))
    X = np.stack([column - 9.5, 129.5 - row], axis=1) / 100.0
    u = np.stack([np.zeros_like(X), *(NodalField.of(mesh_of(forward), each).at(X) for each in seen(forward))])
    # Errors that a point has of its own, or nothing would tell how noisy the points are.
    u[1:] += np.random.default_rng(0).normal(size=u[1:].shape) * 1e-5
    u[2, list(lost)] = np.nan
    return Correlated(
        column=column, row=row, displacement=100.0 * u * (1.0, -1.0), correlation=np.ones(u.shape[:2]), step=4
    )


def measured(folder, change=lambda points: points, lost=(), least=0.0, **case):
    forward = forward_file(folder)
    points = change(exact_points(read(forward), lost)).to_dataset()
    place = {"mm_per_pixel": 0.01, "origin_column": 9.5, "origin_row": 129.5, "least_noise": [least, 0.0]}
    path = folder / "correlated.nc"
    write(
        path, {key: points[key].values for key in points}, "points", {"units": SYNTHETIC_UNITS, **points.attrs, **place}
    )
    config = check_config({**RAW, "cases": {"s": {**RAW["cases"]["s"], **case}}})
    photographed.run(config, "s", str(forward), str(path), str(folder / "measurement.nc"), {})
    return read(folder / "measurement.nc")


def test_points_lie_where_they_are_in_the_sheet_and_move_as_it_does(tmp_path):
    found = measured(tmp_path)
    mesh = mesh_of(found)
    error = found["u_measured"].values[0] - found["u_truth"].values
    assert np.nanmax(np.abs(error)) < 6e-5 and np.isfinite(error).mean() > 0.99
    nodal = displacement(MESH.nodes, 1.1) - displacement(np.array([[0.6, 0.5]]), 1.1)
    np.testing.assert_allclose(found["u_truth"].values[1], NodalField.of(MESH, nodal).at(mesh.nodes), atol=1e-12)
    # Only whole subsets count: their middles are 7.5 pixels from the edge at least.
    assert (mesh.lower >= 0.075).all() and (mesh.lower < 0.075 + 0.04).all()
    assert (mesh.upper <= MESH.upper - 0.075).all() and (mesh.upper > MESH.upper - 0.075 - 0.04).all()
    np.testing.assert_array_equal(found["stretch"].values, STRETCHES)


def test_forces_are_the_share_that_the_grid_carries_and_the_outline_is_no_edge(tmp_path):
    found = measured(tmp_path)
    mesh, force = mesh_of(found), found["edge_force"].values
    np.testing.assert_allclose(force[:, EDGE_NAMES.index("right"), 0], PULL * mesh.size[1] / 1.0)
    np.testing.assert_allclose(force[:, EDGE_NAMES.index("top"), 1], PULL * mesh.size[0] / 1.2)
    np.testing.assert_allclose(force[:, EDGE_NAMES.index("left"), 0], -PULL * mesh.size[1] / 1.0)
    assert np.isnan(force[:, EDGE_NAMES.index("right"), 1]).all()
    assert found.attrs["outline"] == "cut" and found.attrs["mesh"] == "finer"
    # A subset of 15 pixels of 0.01, as wide as the engine is measured to see it.
    assert found.attrs["correlation_window"] == pytest.approx(0.15 * 0.98)
    assert found.attrs["correlation_kernel"] == "average"
    assert found.attrs["force_uncertainty"] == pytest.approx(0.01) and json.loads(found.attrs["load_cases"]) == ["pull"]


def test_noise_is_told_from_the_points_and_errors_of_the_load_cell_are_added(tmp_path):
    found = measured(tmp_path, noise="cell")
    assert found["noise_scatter"].values == pytest.approx(1e-5, rel=0.3)
    read_force = found["edge_force"].values[:, EDGE_NAMES.index("right"), 0] / (PULL * mesh_of(found).size[1])
    assert read_force[0] == pytest.approx(read_force[1]) and abs(read_force[0] - 1.0) > 1e-3
    assert found.attrs["force_gain_uncertainty"] == pytest.approx(0.1)


def test_noise_is_no_less_than_what_grey_noise_alone_makes(tmp_path):
    found = measured(tmp_path, least=0.02)
    for key in ("noise_scatter", "noise_level"):
        np.testing.assert_allclose(found[key].values[:, 0], 2e-4)
        assert (found[key].values[:, 1] < 5e-5).all()


def test_a_lost_point_stays_lost(tmp_path):
    points = exact_points(read(forward_file(tmp_path)))
    inner = np.flatnonzero((points.column == 64) & (points.row == 80))
    found = measured(tmp_path, lost=inner)
    at = np.isclose(mesh_of(found).nodes, (np.array([64 - 9.5, 129.5 - 80]) / 100.0)).all(axis=1)
    assert (
        np.isnan(found["u_measured"].values[0, 1, at]).all() and np.isfinite(found["u_measured"].values[0, 0, at]).all()
    )
    assert found.attrs["lost_points"] >= 1


def test_too_few_whole_subsets_are_refused(tmp_path):
    def few(points):
        kept = (points.column < 25) & (points.row < 125)
        names = ("column", "row")
        return replace(
            points,
            **{key: getattr(points, key)[kept] for key in names},
            displacement=points.displacement[:, kept],
            correlation=points.correlation[:, kept],
        )

    with pytest.raises(DicError, match="positions: no grid"):
        measured(tmp_path, few)


def pictures(folder, forward):
    settings = {"size": [1.2, 1.0], "thickness": None, "mm_per_pixel": 0.01, "speckle": {"seed": 2, "diameter": 4.0}}
    speckle.run(settings, "s", str(folder / "speckle.nc"), {})
    chosen = {"mm_per_pixel": 0.01, "pictures": {"margin": 10, "noise": 1.0}}
    photograph.run(chosen, "s", str(forward), str(folder / "speckle.nc"), str(folder / "pictures.nc"), {})
    return folder / "pictures.nc"


def test_a_pictures_file_says_where_the_sheet_lies_in_it(tmp_path):
    file = read(pictures(tmp_path, forward_file(tmp_path)))
    assert file["picture"].dtype == np.uint8 and file["picture"].shape[0] == 1 + len(STRETCHES)
    row, column = np.nonzero(file["on_sheet"].values)
    origin = np.array([file.attrs["origin_column"], file.attrs["origin_row"]])
    low, high = np.array([column.min() - 0.5, row.max() + 0.5]), np.array([column.max() + 0.5, row.min() - 0.5])
    np.testing.assert_allclose((low - origin) * (0.01, -0.01), MESH.lower, atol=1e-12)
    np.testing.assert_allclose((high - origin) * (0.01, -0.01), MESH.upper, atol=1e-12)
    on_sheet = file["picture"].values[0][file["on_sheet"].values > 0]
    assert on_sheet.mean() > 80 and file["picture"].values[0][file["on_sheet"].values == 0].mean() < 40


def test_an_engine_follows_the_points_of_the_pictures(tmp_path):
    try:
        python_of("pyvale")
    except EngineMissing as missing:
        pytest.skip(str(missing))
    forward = forward_file(tmp_path)
    taken = pictures(tmp_path, forward)
    settings = RAW["cases"]["s"]["camera"]["correlation"]
    correlate.run(settings, "s", str(taken), str(tmp_path / "correlated.nc"), 1, {})
    photographed.run(check_config(RAW), "s", str(forward), str(tmp_path / "correlated.nc"), str(tmp_path / "m.nc"), {})
    found = read(tmp_path / "m.nc")
    error = (found["u_measured"].values[0] - found["u_truth"].values) / 0.01
    assert np.sqrt(np.nanmean(error**2)) < 0.05 and np.isfinite(error).mean() > 0.95


def test_finite_elements_leave_what_grey_levels_say_where_the_sheet_is(tmp_path):
    forward = forward_file(tmp_path)
    taken = pictures(tmp_path, forward)
    camera = RAW["cases"]["s"]["camera"] | {"correlation": {"engine": "finite_elements", "step": 8}}
    config = check_config({**RAW, "cases": {"s": {**RAW["cases"]["s"], "camera": camera}}})
    correlate.run(camera["correlation"], "s", str(taken), str(tmp_path / "correlated.nc"), 1, {})
    photographed.run(config, "s", str(forward), str(tmp_path / "correlated.nc"), str(tmp_path / "m.nc"), {})
    found = read(tmp_path / "m.nc")
    mesh, error = mesh_of(found), found["u_measured"].values[0] - found["u_truth"].values
    assert found.attrs["correlation_window"] == 0.0
    # Nodes lie three pixels of 0.01 within the sheet, or further where a whole element no longer fits.
    assert (mesh.lower >= 0.03).all() and (mesh.upper <= MESH.upper - 0.03).all()
    assert (mesh.size > MESH.upper - 0.06 - 0.08).all()
    np.testing.assert_allclose(np.sqrt(np.nanmean(error**2, axis=1)), found["noise_scatter"].values, rtol=0.35)
    assert (found["noise_level"].values < found["noise_scatter"].values).all()
    information = information_of(found)
    lower, upper = information.mesh.nodes.min(axis=0), information.mesh.nodes.max(axis=0)
    np.testing.assert_allclose(np.stack([lower, upper]), np.stack([mesh.lower, mesh.upper]))
    assert len(information.mesh.cells) == 4 * len(mesh.cells)
    middle = displacement(np.array([[0.6, 0.5]]), STRETCHES[-1])
    truth = displacement(information.mesh.nodes, STRETCHES[-1]) - middle
    root, most_likely, _ = information.root(1, np.ones(len(information.mesh.cells), bool))
    left = root @ truth.ravel() - most_likely
    assert np.mean(left**2) == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / len(left)) + 0.1)
