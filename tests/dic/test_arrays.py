"""Frames of one file of arrays."""

import netCDF4
import numpy as np
import pytest
import scipy.io

from hypernode.config.specimens import Specimen
from hypernode.dic.array_files import arrays_in
from hypernode.dic.errors import DicError
from hypernode.dic.labels import labelled_shape
from hypernode.dic.load_case import import_load_case
from hypernode.dic.reading import read_test
from hypernode.inspection.folder import inspect

from .pulls import LINES, fields

SIZE = {"width": 12.0, "height": 12.0, "thickness": 1.0}


def specimen(folder, **keys):
    given = {"width": 12, "height": 12, "thickness": 1, "load": "clamped_y", "format": "auto"}
    return Specimen.model_validate({"folder": str(folder), **given, **keys})


def arrays(order=(0, 1, 2), names=("DIC_X", "DIC_disp", "instron_force")):
    y, x = np.meshgrid(LINES, LINES, indexing="ij")
    u = np.stack(fields()).reshape(9, -1, 2)
    values = (np.stack([x.ravel(), y.ravel()], axis=1), np.transpose(u, order), 0.5 * np.arange(9.0))
    return dict(zip(names, values, strict=True))


@pytest.mark.parametrize("order", [(0, 1, 2), (1, 2, 0), (1, 0, 2), (0, 2, 1)])
def test_known_names_of_an_npz_are_frames_with_their_forces(tmp_path, order):
    np.savez(tmp_path / "pull.npz", **arrays(order))
    test = specimen(tmp_path, arrays={"unit": "mm"})
    case = import_load_case(test, test)
    assert case.stretch[-1] == pytest.approx(1.16, abs=0.002)
    assert case.force[1, 1][-1] == pytest.approx(4.0)


def test_a_matlab_file_with_names_of_its_own_is_read(tmp_path):
    scipy.io.savemat(tmp_path / "pull.mat", arrays(names=("P", "D", "N")))
    series = read_test(specimen(tmp_path, arrays={"positions": "P", "displacements": "D", "force": "N", "unit": "mm"}))
    assert [frame.force for frame in series.frames] == pytest.approx(0.5 * np.arange(9.0))


def test_arrays_without_unit_and_of_odd_shapes_are_refused_with_the_way_out(tmp_path):
    np.savez(tmp_path / "pull.npz", **arrays(names=("positions", "DIC_disp", "force")))
    with pytest.raises(DicError, match=r"arrays=.unit: mm"):
        read_test(specimen(tmp_path))
    np.savez(tmp_path / "pull.npz", **arrays() | {"DIC_disp": np.zeros((9, 7, 2))})
    with pytest.raises(DicError, match=r"shape \(9, 7, 2\) for 169 points"):
        read_test(specimen(tmp_path, arrays={"unit": "mm"}))


def images(**more):
    """Arrays by rows and columns, as a data set of images has them, with the way of the crosshead."""
    flat, side = arrays(), len(LINES)
    return {
        "DIC_X": flat["DIC_X"].reshape(side, side, 2),
        "DIC_disp": flat["DIC_disp"].reshape(9, side, side, 2),
        "instron_force": flat["instron_force"],
        "instron_disp": 12.0 * 0.02 * np.arange(9.0),
        "label": (flat["DIC_X"].reshape(side, side, 2)[..., 0] > 5.0).astype(int),
        **more,
    }


def hdf5(path, values):
    with netCDF4.Dataset(path, "w") as file:
        for name, value in values.items():
            value = np.asarray(value)
            axes = [f"{name}_{k}" for k in range(value.ndim)]
            for axis, size in zip(axes, value.shape, strict=True):
                file.createDimension(axis, size)
            file.createVariable(name, value.dtype, axes)[...] = value
    return path


@pytest.mark.parametrize(
    "write", [lambda path, values: np.savez(f"{path}.npz", **values), lambda p, v: hdf5(f"{p}.h5", v)]
)
def test_arrays_by_rows_and_columns_are_read_without_a_key_and_their_crosshead_is_compared(tmp_path, write):
    write(tmp_path / "pull", images())
    found = inspect(tmp_path, SIZE)
    case = found.sheet.cases[0]
    assert case.stretch[-1] == pytest.approx(1.16, abs=0.002) and case.force[1, 1][-1] == pytest.approx(4.0)
    assert not found.known.missing and found.cycle.record.displacement[-1, 0] == pytest.approx(1.92)
    assert any("'label' names 2 kinds" in each and "shape_image: pull" in each for each in found.field.said)
    write(tmp_path / "pull", images(instron_disp=120.0 * 0.02 * np.arange(9.0)))
    (missing,) = inspect(tmp_path, SIZE).known.missing
    assert "the crosshead moves by" in missing.sentence and "(10)" in missing.sentence


def test_hdf5_of_one_frame_after_another_and_of_any_order_of_axes(tmp_path):
    hdf5(tmp_path / "pull.hdf5", {k: np.asarray(v).T for k, v in images().items() if k != "label"})
    series = read_test(specimen(tmp_path))
    assert len(series.frames) == 9
    np.testing.assert_allclose(series.frames[8].displacement, np.swapaxes(fields()[8], 0, 0), atol=1e-12)


@pytest.mark.parametrize("name", ["pull.npz", "pull.h5", "pull.mat"])
@pytest.mark.parametrize("share", [0.1, 0.5, 0.95])
def test_a_file_of_arrays_that_is_cut_off_is_refused_as_such(tmp_path, name, share):
    path = tmp_path / name
    if name == "pull.npz":
        np.savez(path, **images())
    elif name == "pull.h5":
        hdf5(path, images())
    else:
        scipy.io.savemat(path, images())
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    for chosen in ("arrays", "auto"):
        with pytest.raises(DicError, match=f"{name}: cannot be read as arrays"):
            read_test(specimen(tmp_path, format=chosen))


def test_arrays_of_unknown_names_are_listed_with_the_key_that_says_which_they_are(tmp_path):
    np.savez(tmp_path / "pull.npz", **arrays(names=("P", "D", "N")))
    with pytest.raises(DicError, match=r"holds the arrays 'D', 'N', 'P': say which are what, --set 'arrays=\{"):
        read_test(specimen(tmp_path))


@pytest.mark.parametrize("y_up", [True, False])
def test_labels_of_points_are_a_shape_with_which_the_identified_one_is_compared(tmp_path, y_up):
    y = images()["DIC_X"][..., 1]
    disc = (np.hypot(images()["DIC_X"][..., 0] - 4.0, y - 8.0) < 3.0).astype(int)
    np.savez(tmp_path / "pull.npz", **images(label=disc + 7))
    inside = labelled_shape(tmp_path / "pull.npz", {}, y_up)
    height = 8.0 if y_up else 4.0
    np.testing.assert_array_equal(
        inside(np.array([[4.0, height], [11.0, 11.0], [4.0, 12.0 - height]]) / 12.0), [1, 0, 0]
    )


def test_labels_that_are_none_of_points_are_said_and_refused_as_a_shape(tmp_path):
    np.savez(tmp_path / "pull.npz", **images(label=np.arange(9)))
    assert any("is not used" in each for each in inspect(tmp_path, SIZE).field.said)
    with pytest.raises(DicError, match="no array with a label of every point"):
        labelled_shape(tmp_path / "pull.npz", {}, True)


def test_arrays_of_one_component_each_are_read_as_those_of_both(tmp_path):
    flat = arrays()
    each = {"X": flat["DIC_X"][:, 0], "Y": flat["DIC_X"][:, 1], "force": flat["instron_force"]}
    scipy.io.savemat(tmp_path / "pull.mat", {**each, "U": flat["DIC_disp"][..., 0], "V": flat["DIC_disp"][..., 1]})
    case = inspect(tmp_path, {**SIZE, "arrays": {"unit": "mm"}}).sheet.cases[0]
    assert case.stretch[-1] == pytest.approx(1.16, abs=0.002) and case.force[1, 1][-1] == pytest.approx(4.0)


def of_two_axes():
    """Lines of a grid of 13 x 12 points, u and v (frame, row, column), and forces."""
    u = np.stack(fields())[:, :12]
    return LINES, LINES[:12], u[..., 0], u[..., 1], 0.5 * np.arange(9.0)


def right(case, force=4.0):
    assert case.stretch[-1] == pytest.approx(1.16, abs=0.002)
    assert case.force[1, 1][-1] == pytest.approx(force)


@pytest.mark.parametrize("turn", [False, True])
def test_positions_may_be_the_lines_of_a_grid(tmp_path, turn):
    x, y, u, v, force = of_two_axes()
    u, v = (np.swapaxes(each, 1, 2) if turn else each for each in (u, v))
    np.savez(tmp_path / "pull.npz", x=x, y=y, u=u, v=v, force=force)
    test = specimen(tmp_path, arrays={"unit": "mm"})
    right(import_load_case(test, test))


def test_lines_of_a_square_grid_are_not_taken_for_points(tmp_path):
    u = np.stack(fields())
    np.savez(tmp_path / "pull.npz", x=LINES, y=LINES, u=u[..., 0], v=u[..., 1], force=0.5 * np.arange(9.0))
    test = specimen(tmp_path, arrays={"unit": "mm"})
    right(import_load_case(test, test))


def test_arrays_in_a_group_are_read(tmp_path):
    with netCDF4.Dataset(tmp_path / "pull.h5", "w") as file:
        group = file.createGroup("dic")
        for name, value in images().items():
            axes = [f"{name}_{k}" for k in range(value.ndim)]
            for axis, size in zip(axes, value.shape, strict=True):
                group.createDimension(axis, size)
            group.createVariable(name, value.dtype, axes)[...] = value
    test = specimen(tmp_path)
    right(import_load_case(test, test))


@pytest.mark.parametrize("moving", [0.0, 1.0])
def test_positions_of_every_frame_are_those_at_rest_or_move_with_the_sheet(tmp_path, moving):
    whole = images()
    positions = whole["DIC_X"] + moving * whole["DIC_disp"]
    np.savez(tmp_path / "pull.npz", **whole | {"DIC_X": np.broadcast_to(positions, whole["DIC_disp"].shape)})
    test = specimen(tmp_path)
    right(import_load_case(test, test))
    np.savez(tmp_path / "pull.npz", **whole | {"DIC_X": whole["DIC_X"] + 0.5 * whole["DIC_disp"]})
    with pytest.raises(DicError, match="store those at rest as"):
        read_test(test)


def test_a_file_of_arrays_a_frame_is_a_series(tmp_path):
    x, y, u, v, _ = of_two_axes()
    for k in range(9):
        np.savez(tmp_path / f"frame{k:02d}.npz", x=x, y=y, u=u[k], v=v[k])
    series = read_test(specimen(tmp_path, arrays={"unit": "mm"}))
    assert [frame.number for frame in series.frames] == list(range(9))
    np.testing.assert_allclose(series.frames[8].displacement[..., 1], v[8])


def test_single_arrays_are_told_how_they_become_one_file(tmp_path):
    for name, values in zip("xyuv", of_two_axes(), strict=False):
        np.save(tmp_path / name, values)
    with pytest.raises(DicError, match=r"'u.npy'.*numpy.savez"):
        read_test(specimen(tmp_path))


def test_lines_of_different_lengths_need_an_array_with_both(tmp_path):
    file = tmp_path / "frames.npz"
    np.savez(file, x=np.arange(4000.0), y=np.arange(3000.0))
    assert "x y" not in arrays_in(file)


def test_one_frame_a_file_on_the_lines_of_a_square_grid_is_read(tmp_path):
    x = np.arange(13.0)
    for number in range(3):
        X, Y = np.meshgrid(x, x)
        np.savez(tmp_path / f"frame_{number}.npz", x=x, y=x, u=0.01 * number * X, v=0.02 * number * Y)
    arrays = arrays_in(tmp_path / "frame_1.npz")
    assert arrays["x y"].shape == (13, 13, 2)


def test_a_matlab_file_that_begins_with_zeros_is_refused_as_such(tmp_path):
    path = tmp_path / "pull.mat"
    scipy.io.savemat(path, images())
    path.write_bytes(bytes(40) + path.read_bytes()[40:])
    with pytest.raises(DicError, match=r"pull\.mat: cannot be read as arrays: .*corrupt"):
        arrays_in(path)
