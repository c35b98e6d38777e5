"""A synthetic sheet with a thickness has the units and the forces of a real one."""

import numpy as np
import pytest

from hypernode.config.loading import ConfigError, check_config
from hypernode.stages import forward, true_material
from hypernode.storage.netcdf import EXPERIMENT_UNITS, SYNTHETIC_UNITS, read, units_of

SHEET = {"geometry": "all", "matrix": "rubber", "loads": ["pull"], "cells": [3, 3], "size": [40.0, 40.0]}


def config(**case):
    return check_config(
        {
            "geometries": {"all": {"shape": "uniform"}},
            "materials": {"rubber": {"model": "neo_hookean", "mu": 0.2}},
            "loads": {"pull": {"kind": "uniaxial_y", "stretches": [1.1]}},
            "cases": {"s": SHEET | case},
        }
    )


def solved(folder, **case):
    folder.mkdir()
    material, solution = (str(folder / f"{stage}.nc") for stage in ("true_material", "forward"))
    true_material.run(config(**case), "s", material, {})
    forward.run(config(**case), "s", material, solution, {})
    return read(solution)


def test_forces_are_the_stress_over_width_and_thickness_in_newton(tmp_path):
    plain, thick = solved(tmp_path / "plain"), solved(tmp_path / "thick", thickness=2.0)
    assert units_of(plain) == SYNTHETIC_UNITS and units_of(thick) == EXPERIMENT_UNITS
    # Uniaxial neo-Hookean: P = mu (stretch - stretch^-2), over 40 x 2 mm.
    stress = 0.2 * (1.1 - 1.1**-2)
    assert thick["edge_force"].values[0, 3, 1] == pytest.approx(80.0 * stress, rel=1e-6)
    for key in ("edge_force", "nodal_force"):
        np.testing.assert_allclose(thick[key].values, 2.0 * plain[key].values, rtol=1e-9, atol=1e-9)
    assert (plain.attrs["thickness"], thick.attrs["thickness"]) == (1.0, 2.0)


def test_the_thickness_of_a_specimen_is_not_said_in_its_case(tmp_path):
    specimen = {"folder": str(tmp_path), "width": 40, "height": 40, "thickness": 2, "pixel_size": 0.04, "frame_rate": 5}
    with pytest.raises(ConfigError, match="said under 'specimens'"):
        check_config({"specimens": {"mine": specimen}, "cases": {"s": {"specimen": "mine", "thickness": 1.0}}})
