"""Two tests of a sheet under one load, at two paces, are read as those of one material."""

import json

import numpy as np
import pytest

from hypernode.config.loading import check_config
from hypernode.dic.series import Frame, Series
from hypernode.dic.writing import write_force_record, write_series
from hypernode.stages import import_dic
from hypernode.storage.netcdf import read

SIDE, TOP, FRAMES = 10.0, 0.2, 13
LINES = np.linspace(0.0, SIDE, 6)
#: Share of the relaxed stiffness that relaxes, in so many seconds.
SHARE, TAU = 0.3, 2.0


def force_of(time, pace):
    """Force of a neo-Hookean sheet that relaxes, pulled at a rate of the stretch."""
    stretch = 1.0 + pace * time
    elastic = 20.0 * (stretch - stretch**-2)
    later = time[:, None] - time
    kernel = np.exp(-np.abs(later) / TAU) * (later >= 0.0)
    return elastic + SHARE * np.trapezoid(kernel * np.gradient(elastic, time), time, axis=1), elastic


def written(folder, duration, load="uniaxial_y"):
    """Frames and record of a test that lasts so many seconds."""
    stretches = 1.0 + np.linspace(0.0, TOP, FRAMES)
    grid = np.stack(np.meshgrid(LINES, LINES), axis=-1)
    along = [load.endswith(axis) for axis in "xy"]
    gradients = [np.diag(np.where(along, s - 1.0, s**-0.5 - 1.0)) for s in stretches]
    frames = [Frame(k, grid @ gradient) for k, gradient in enumerate(gradients)]
    write_series(Series(LINES, LINES, frames, unit="mm"), folder)
    time = np.linspace(0.0, duration, 601)
    force, _ = force_of(time, TOP / duration)
    write_force_record(folder / "force_disp.csv", time, {load[-1]: SIDE * TOP * time / duration}, {load[-1]: force})
    return {"folder": str(folder), "load": load, "frame_rate": (FRAMES - 1) / duration}


def imported(tmp_path, *tests):
    sizes = {"width": SIDE, "height": SIDE, "thickness": 1.0, "noise_mm": 1e-6, "outline": "edge", "load_steps": 4}
    config = check_config({"specimens": {"s": {**sizes, "tests": list(tests)}}})
    import_dic.run(config, "s", str(tmp_path / "m.nc"), {})
    return read(tmp_path / "m.nc")


def test_forces_of_two_paces_are_those_of_one_elastic_sheet(tmp_path):
    durations = 6.0, 60.0
    data = imported(tmp_path, *(written(tmp_path / f"{duration:g}", duration) for duration in durations))
    rigid = data["edge_force"].values[:, 3, 1] / data["relaxation"].values
    time = np.linspace(0.0, durations[0], 601)
    elastic = np.interp(data["stretch"], 1.0 + TOP * time / durations[0], force_of(time, TOP / durations[0])[1])
    level = rigid / elastic
    spread = np.sqrt(np.mean(data["force_relaxation_uncertainty"].values ** 2))
    assert np.std(level / level.mean()) <= 2.0 * spread and spread <= 0.03
    # As they were recorded, the fast test is stiffer.
    said = (data["edge_force"].values[:, 3, 1] / elastic).reshape(2, -1).mean(axis=1)
    assert said[0] > 1.1 * said[1]
    assert len(set(json.loads(data.attrs["pace"]))) == 1


@pytest.mark.parametrize("other", [("uniaxial_x", 60.0), ("uniaxial_y", 9.0)], ids=["another load", "nearly as fast"])
def test_other_tests_are_judged_by_their_own_records(tmp_path, capsys, other):
    load, duration = other
    imported(tmp_path, written(tmp_path / "a", 6.0), written(tmp_path / "b", duration, load))
    said = capsys.readouterr().err
    assert said.count("the record has evidence") == 2 and "two paces" not in said
