"""The same test is the same material, whatever software wrote its frames."""

import functools

import numpy as np
import pytest

from hypernode.config.loading import check_config
from hypernode.config.methods import Constrained
from hypernode.dic.writing import write_force_record
from hypernode.identification.strategy import identify
from hypernode.mechanics.loads import make_load
from hypernode.stages import import_dic
from hypernode.storage.netcdf import read
from tests.dic.exports import MM, Sheet, export
from tests.sheets import sheet, square

CELLS = 10
#: Software that writes mm, one of each kind: deformed positions, a preamble, decimal commas, lost points marked.
CASES = ("table", "davis_mm", "vic3d, German", "matchid_2024", "gom", "gom_nodemap", "davis8")
SETTINGS = Constrained(terms=["I1_squared"], iterations=30)


@functools.cache
def solved():
    return sheet(CELLS, square, make_load("clamped_y", [1.05, 1.1]))[0]


def displacement(k, X, Y):
    """Of a point of the grid, in mm."""
    if k == 0:
        return 0.0, 0.0
    node = round(Y / MM) * (CELLS + 1) + round(X / MM)
    # Some software writes zeros where a point is lost: the sheet moves as a whole, so that none is exactly there.
    return tuple(CELLS * MM * solved()["u_measured"].values[0, k - 1, node] + 0.01 * MM * k)


@functools.cache
def identified(folder, case):
    """Parameters of the field found from a folder of one software's frames."""
    folder.mkdir(exist_ok=True)
    export(folder, case, Sheet(columns=CELLS + 1, rows=CELLS + 1, displacement=displacement, lost=57, digits=17))
    force = np.append(0.0, solved()["edge_force"].values[:, 3, 1]) * CELLS * MM
    write_force_record(folder / "force_disp.csv", np.arange(3.0), {"y": np.arange(3.0)}, {"y": force})
    size = CELLS * MM
    specimen = {
        "folder": str(folder), "width": size, "height": size, "thickness": 1.0, "frame_rate": 1.0,
        "noise_mm": 1e-6 * size, "outline": "edge", "load_steps": 2, "relaxation": False, "format": case.split(",")[0],
    }  # fmt: skip
    import_dic.run(check_config({"specimens": {"s": specimen}}), "s", str(folder / "m.nc"), {})
    return identify(read(folder / "m.nc"), SETTINGS, case).params


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES[1:])
def test_whoever_wrote_the_frames_the_material_is_the_same(tmp_path_factory, case):
    first = identified(tmp_path_factory.getbasetemp() / "first", CASES[0])
    np.testing.assert_allclose(identified(tmp_path_factory.mktemp("other"), case), first, rtol=1e-6, atol=1e-6)
