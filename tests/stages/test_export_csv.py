"""A measurement that is exported is read back to the same bits, and the configuration beside it imports it."""

import re
from pathlib import Path

import numpy as np
import pytest

import hypernode
from hypernode import cli
from hypernode.config.sources import read_yaml
from hypernode.config.specimens import Specimen
from hypernode.data.loading import load_kind
from hypernode.dic.errors import DicError
from hypernode.dic.forces.record import read_force_record
from hypernode.dic.reading import read_series
from hypernode.dic.specimen import import_specimen
from hypernode.fem.mesh import EDGE_NAMES, rectilinear
from hypernode.mechanics.loads import CONSTRAINED, make_load
from hypernode.stages import export_csv
from hypernode.stages.imported_sheet import attributes_of, variables_of
from hypernode.storage.netcdf import EXPERIMENT_UNITS, SYNTHETIC_UNITS, read, write
from tests.sheets import sheet

X, Y = np.arange(7) / 6.0, np.linspace(0.0, 1.4, 9)
# What a general test does to a sheet, no kind of load says.
KINDS = [kind for kind in CONSTRAINED if kind != "general"]
STRETCHES = {kind: [(s, s) if kind == "biaxial" else s for s in (1.03, 1.07, 1.1)] for kind in KINDS}
#: Loads of a specimen by those of a synthetic test.
LOADS = {kind: {"equibiaxial": "biaxial", "biaxial_clamped": "general"}.get(kind, kind) for kind in KINDS}


def measurement(folder, kinds=("clamped_y",), units=SYNTHETIC_UNITS, noise=0.01, repeats=2, y=Y, **changes):
    """A file with random displacements around those of its loads, and forces that rise with them."""
    random = np.random.default_rng(5)
    keep = np.ones((len(Y) - 1, len(X) - 1), bool)
    keep[3:5, 2:4] = False
    mesh = rectilinear(X, y, keep)
    loads = [make_load(kind, STRETCHES[kind]) for kind in kinds]
    H = np.concatenate([load.H for load in loads])
    u = np.einsum("sij,nj->sni", H, mesh.nodes) + noise * random.normal(size=(repeats, len(H), len(mesh.nodes), 2))
    u[:, 1, 20] = np.nan
    u[0, 2, 11] = np.nan
    force, held = np.zeros((len(H), 4, 2)), np.zeros((len(H), 4, 2))
    for step, kind in enumerate(np.repeat(kinds, 3)):
        for edge, component in CONSTRAINED[kind]:
            held[step, EDGE_NAMES.index(edge), component] = 1.0
    for low, high in ((0, 1), (2, 3)):
        force[:, high] = held[:, high] * (0.3 + np.abs(H).max(axis=(1, 2)))[:, None] * [1.0, 0.7] / 3.0
        force[:, low] = -force[:, high]
    variables = {
        "X": mesh.nodes, "cells": mesh.cells, "corners": np.stack([mesh.lower, mesh.upper]), "u_measured": u,
        "load_case": np.repeat(np.arange(len(kinds)), 3), "stretch": 1.0 + H.max(axis=(1, 2)), "H": H,
        "edge_force": force, "edge_constrained": held, "relaxation": np.ones(len(H)),
        "noise_level": np.full((len(H), 2), noise), "noise_scatter": np.full((len(H), 2), noise), **changes,
    }  # fmt: skip
    attributes = {
        "units": units, "load_cases": list(kinds), "outline": "edge", "thickness": 1.55, "forces": "measured",
        "force_uncertainty": 0.02, "force_gain_uncertainty": 0.03, "force_offset_uncertainty": 0.004,
        "correlation_window": 0.1,
    }  # fmt: skip
    path = folder / "results/sheet/measurement.nc"
    write(path, variables, "synthetic measurement of sheet", attributes)
    return path


def exported(path, tmp_path):
    """(specimen of the written configuration, its text)."""
    written = export_csv.run(path, tmp_path / "out")
    assert written == tmp_path / "out/specimen.yaml"
    return read_yaml(written).content["specimens"]["sheet"], written.read_text()


def mean_of_repeats(data):
    u = data["u_measured"].values
    known = np.isfinite(u).sum(axis=0)
    return np.where(known > 0, np.nansum(u, axis=0) / np.maximum(known, 1), np.nan)


def on_nodes(series, data):
    """Displacements of the deformed frames at the nodes of a file."""
    row, column = (np.searchsorted(line, data["X"].values[:, k]) for line, k in ((series.y, 1), (series.x, 0)))
    return np.stack([frame.displacement[row, column] for frame in series.frames[1:]])


@pytest.mark.parametrize("kind", KINDS)
def test_every_load_case_is_read_back_to_the_same_bits(tmp_path, kind):
    path = measurement(tmp_path, ("clamped_y", kind))
    data, (specimen, _) = read(path), exported(path, tmp_path)
    assert [test["load"] for test in specimen["tests"]] == ["clamped_y", LOADS[kind]]
    for k, test in enumerate(specimen["tests"]):
        steps = slice(3 * k, 3 * k + 3)
        series = read_series(tmp_path / f"out/test{k}")
        assert series.unit == "mm" and [frame.number for frame in series.frames] == [0, *test["frames"]]
        np.testing.assert_array_equal(series.x, X)
        np.testing.assert_array_equal(series.y, Y)
        np.testing.assert_array_equal(on_nodes(series, data), mean_of_repeats(data)[steps])
        inside = np.isfinite(series.frames[0].displacement).all(axis=-1)
        assert inside.sum() == data.sizes["node"] and not series.frames[0].displacement[inside].any()
        record = read_force_record(tmp_path / f"out/test{k}/force_disp.csv")
        np.testing.assert_array_equal(record.time * test["frame_rate"], np.arange(4))
        edge = EDGE_NAMES.index("right" if test["load"].endswith("_x") else "top")
        for axis in {"clamped_y": "y", "uniaxial_y": "y", "clamped_x": "x", "uniaxial_x": "x"}.get(test["load"], "xy"):
            at = EDGE_NAMES.index("right") if axis == "x" and test["load"] in ("biaxial", "general") else edge
            force = data["edge_force"].values[steps, at, "xy".index(axis)]
            np.testing.assert_array_equal(record.force[:, record.column(axis)], [0.0, *force])
        assert (np.diff(record.displacement[:, 0]) > 0.0).all()


def test_the_configuration_imports_one_test_to_the_same_bits(tmp_path):
    path = measurement(tmp_path)
    data, (specimen, _) = read(path), exported(path, tmp_path)
    specimen = Specimen.model_validate(specimen)
    assert specimen.outline == "edge" and specimen.thickness == 1.55
    assert specimen.noise_mm == pytest.approx(0.01 / np.sqrt(2.0), rel=1e-15)
    assert (specimen.correlation_window, specimen.force_uncertainty) == (0.1, 0.02)
    test = import_specimen(specimen)
    place = [int(np.flatnonzero((test.mesh.nodes == node).all(axis=1))[0]) for node in data["X"].values]
    np.testing.assert_array_equal(test.u[:, place], mean_of_repeats(data))
    held = data["edge_constrained"].values > 0
    np.testing.assert_array_equal(test.constrained > 0, held)
    along = np.s_[:, 2:, 1]
    np.testing.assert_array_equal(test.edge_force[along], data["edge_force"].values[along])


def test_forces_are_those_of_an_elastic_sheet_and_the_configuration_says_so(tmp_path):
    factor = np.array([1.1, 1.0, 0.9])
    path = measurement(tmp_path, units=EXPERIMENT_UNITS, relaxation=factor)
    specimen, text = exported(path, tmp_path)
    record = read_force_record(tmp_path / "out/test0/force_disp.csv")
    np.testing.assert_array_equal(record.force[1:, 0], read(path)["edge_force"].values[:, 3, 1] / factor)
    assert specimen["relaxation"] is False and "# 1.1, 1, 0.9.\n" in text and "synthetic" not in text


def test_a_force_that_is_known_at_one_end_alone_serves_and_one_that_is_not_known_is_missed(tmp_path):
    path = measurement(tmp_path)
    force = read(path)["edge_force"].values
    force[:, :2], force[:, 2] = np.nan, np.nan
    one_end = measurement(tmp_path, edge_force=force)
    exported(one_end, tmp_path)
    record = read_force_record(tmp_path / "out/test0/force_disp.csv")
    np.testing.assert_array_equal(record.force[1:, 0], force[:, 3, 1])
    force[1, 3] = np.nan
    none = measurement(tmp_path, edge_force=force)
    with pytest.raises(DicError, match=r"measurement\.nc: load step 1 carries no known force along y"):
        export_csv.run(none, tmp_path / "other")
    assert not (tmp_path / "other").exists()


def test_a_sheet_without_noise_has_that_of_rounding(tmp_path):
    specimen, text = exported(measurement(tmp_path, noise=0.0), tmp_path)
    assert 0.0 < specimen["noise_mm"] <= np.spacing(2.0) and "without noise" in text
    assert "a stress of 1 Pa as 1 MPa" in text and "declare the hole" in text and "graded" not in text


def test_a_grid_that_is_graded_is_warned_of(tmp_path):
    _, text = exported(measurement(tmp_path, y=Y**1.2), tmp_path)
    assert "# The grid is graded: an import interpolates it onto an equidistant one." in text


def test_the_command_names_the_configuration_and_overwrites_nothing(tmp_path, capsys):
    path = measurement(tmp_path)
    assert cli.main(["export-csv", str(path), str(tmp_path / "out")]) == 0
    assert capsys.readouterr().out == f"{tmp_path / 'out/specimen.yaml'}\n"
    before = {each: each.read_bytes() for each in (tmp_path / "out").rglob("*.*")}
    assert cli.main(["export-csv", str(path), str(tmp_path / "out")]) == 2
    assert "out: holds something already" in capsys.readouterr().err
    assert {each: each.read_bytes() for each in (tmp_path / "out").rglob("*.*")} == before
    mesh = {key: read(path)[key].values for key in ("X", "cells", "corners")}
    write(tmp_path / "other.nc", mesh, "a mesh", {"units": SYNTHETIC_UNITS})
    assert cli.main(["export-csv", str(tmp_path / "other.nc"), str(tmp_path / "new")]) == 2
    assert "other.nc: is no measurement" in capsys.readouterr().err


@pytest.mark.parametrize("kind", KINDS)
def test_a_load_is_told_from_what_is_held_and_how_it_moves(kind):
    load, held = make_load(kind, STRETCHES[kind]), np.zeros((4, 2), bool)
    for edge, component in load.constrained:
        held[EDGE_NAMES.index(edge), component] = True
    assert load_kind(held, load.H) == LOADS[kind]
    held[0, 1] = not held[0, 1]
    assert load_kind(held, load.H) == "general"


def test_several_tests_are_imported_again_onto_one_grid_with_their_loads_and_forces(tmp_path):
    kinds = ("biaxial", "uniaxial_x", "shear")
    path = measurement(tmp_path, kinds, noise=0.0)
    data, (specimen, _) = read(path), exported(path, tmp_path)
    sheet = import_specimen(Specimen.model_validate(specimen))
    place = [int(np.flatnonzero((sheet.mesh.nodes == node).all(axis=1))[0]) for node in data["X"].values]
    np.testing.assert_allclose(sheet.u[:, place], mean_of_repeats(data), atol=1e-12)
    np.testing.assert_array_equal(sheet.load_case, data["load_case"])
    np.testing.assert_array_equal(sheet.constrained, data["edge_constrained"])
    known = np.isfinite(sheet.edge_force)
    np.testing.assert_allclose(sheet.edge_force[known], data["edge_force"].values[known], rtol=1e-12)
    assert [known[steps].any(axis=0).sum() for steps in (slice(0, 3), slice(3, 6), slice(6, 9))] == [4, 2, 2]


def test_a_sheet_whose_force_nobody_recorded_is_written_without_a_record(tmp_path):
    path = measurement(tmp_path)
    data = read(path)
    attributes = {**data.attrs, "units": SYNTHETIC_UNITS, "load_cases": ["clamped_y"], "forces": "assumed"}
    other = tmp_path / "assumed.nc"
    attributes = {key: attributes[key] for key in ("units", "load_cases", "forces", "outline")}
    attributes |= {"thickness": 1.55, "force_uncertainty": 0.01, "correlation_window": 0.0}
    attributes |= {"force_gain_uncertainty": 0.01, "force_offset_uncertainty": 0.001}
    write(other, {name: data[name].values for name in data.variables}, "measurement", attributes)
    written = export_csv.run(other, tmp_path / "out")
    (specimen,) = read_yaml(written).content["specimens"].values()
    assert specimen["force_file"] is None and not (tmp_path / "out/test0/force_disp.csv").exists()


def test_an_export_is_imported_as_the_same_measurement_with_what_was_stated_of_its_mesh(tmp_path):
    data, *_ = sheet(8, lambda X: X[:, 0], make_load("equibiaxial", [1.1, 1.2]), terms=())
    variables = {name: variable.values for name, variable in data.variables.items()}
    path = tmp_path / "results/sheet/measurement.nc"
    stated = {"units": EXPERIMENT_UNITS, "load_cases": ["equibiaxial"]}
    write(path, variables, "synthetic measurement of sheet", data.attrs | stated)
    content, _ = exported(path, tmp_path)
    specimen = Specimen(**content)
    imported = import_specimen(specimen, None)
    found, attributes = variables_of(imported, np.zeros(2)), attributes_of(specimen, imported, np.zeros(2))
    for name in ("X", "cells", "u_measured", "load_case", "edge_constrained", "relative_thickness"):
        np.testing.assert_array_equal(found[name], variables[name])
    for name in ("edge_force", "H", "stretch", "noise_level"):
        np.testing.assert_allclose(found[name], variables[name], rtol=1e-9, atol=1e-14)
    for name in ("mesh", "noise_uncertainty", "outline", "thickness", "force_uncertainty", "correlation_window"):
        assert attributes[name] == data.attrs[name]


def test_no_module_that_identifies_reads_where_a_measurement_came_from():
    package = Path(hypernode.__file__).parent
    asked = re.compile(r"attrs(\[|\.get\()\"(title|source|history|rule|parents|raw_inputs|noise_sources)\"")
    rooms = ("identification", "training", "polishing", "data", "advice")
    told = [file for room in rooms for file in (package / room).rglob("*.py") if asked.search(file.read_text())]
    assert told == []
