"""Frames of one file of arrays."""

import numpy as np
import pytest
import scipy.io

from hypernode.config.specimens import Specimen
from hypernode.dic.errors import DicError
from hypernode.dic.load_case import import_load_case
from hypernode.dic.reading import read_test

from .pulls import LINES, fields


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
    np.savez(tmp_path / "pull.npz", **arrays())
    with pytest.raises(DicError, match=r"arrays=.unit: mm"):
        read_test(specimen(tmp_path))
    np.savez(tmp_path / "pull.npz", **arrays() | {"DIC_disp": np.zeros((9, 7, 2))})
    with pytest.raises(DicError, match=r"shape \(9, 7, 2\) for 169 points"):
        read_test(specimen(tmp_path, arrays={"unit": "mm"}))
