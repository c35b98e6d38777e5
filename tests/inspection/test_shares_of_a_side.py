"""Displacements that are shares or per cent of a side are told by narrowing or crosshead, with the right factor."""

import numpy as np
import pytest

from hypernode.dic.forces.magnitude import check_crosshead
from hypernode.dic.narrowing import scale_of
from hypernode.inspection.folder import inspect
from tests.inspection.test_magnitudes import GIVEN, PACE, pull, right, said

SIDE = 12.0


@pytest.mark.parametrize("crosshead", [True, False])
@pytest.mark.parametrize(("factor", "mends"), [(100.0 / SIDE, SIDE / 100.0), (1.0 / SIDE, SIDE)])
def test_shares_and_per_cent_of_the_height_are_said_with_the_factor_that_mends(tmp_path, factor, mends, crosshead):
    folder = pull(tmp_path / "pull", factor, crosshead=crosshead, pace=0.04)
    assert f"--set displacement_factor={mends:g} " in said(inspect(folder, GIVEN))
    found = inspect(folder, {**GIVEN, "displacement_factor": mends})
    assert not said(found) and right(found, 0.04)


@pytest.mark.parametrize("crosshead", [True, False])
@pytest.mark.parametrize("pace", [PACE, 0.1])
def test_right_displacements_are_no_shares(tmp_path, crosshead, pace):
    found = inspect(pull(tmp_path / "pull", crosshead=crosshead, pace=pace), GIVEN)
    assert not said(found) and right(found, pace)


def curve(poisson, factor, largest):
    """Elongation and narrowing of a sheet whose displacements have to be multiplied by a factor."""
    e = np.linspace(0.0, largest, 15)
    noise = np.random.default_rng(2).normal(0.0, 1e-4, 15)
    return e / factor, (1.0 - (1.0 + e) ** -poisson + noise) / factor


@pytest.mark.parametrize("poisson", [0.3, 0.4, 0.5])
@pytest.mark.parametrize("side", [10.0, 24.0])
def test_per_cent_of_a_short_side_are_told_by_the_narrowing_alone(poisson, side):
    scale = scale_of(*curve(poisson, side / 100.0, 0.2))
    assert scale.is_of(side / 100.0) and not scale.is_of(1.0)


@pytest.mark.parametrize("poisson", [0.2, 0.35, 0.5])
@pytest.mark.parametrize("largest", [0.02, 0.2, 1.0, 3.0])
@pytest.mark.parametrize("side", [5.0, 12.0, 24.0, 50.0, 120.0])
def test_no_right_sheet_of_a_constant_poisson_ratio_has_the_curve_of_shares(poisson, largest, side):
    scale = scale_of(*curve(poisson, 1.0, largest))
    assert scale is None or not (scale.is_of(side) or scale.is_of(side / 100.0))


def crosshead(side, factor):
    time = np.linspace(0.0, 10.0, 11)
    return check_crosshead(1.0 + 0.02 * time / factor, time, time, 0.02 * side * time, side, whole=True)


@pytest.mark.parametrize("side", [30.0, 60.0, 140.0, 170.0, 400.0])
def test_a_crosshead_names_per_cent_of_any_side(side):
    (finding,) = crosshead(side, side / 100.0)
    assert (
        f"displacement_factor={side / 100.0:g} where displacements are per cent of the {side:g} mm" in finding.sentence
    )


@pytest.mark.parametrize("side", [30.0, 95.0, 104.0, 140.0])
@pytest.mark.parametrize("slips", [1.0, 1.05, 1.2, 1.6])
def test_a_machine_that_gives_is_no_other_unit(side, slips):
    assert crosshead(side, slips) == []
