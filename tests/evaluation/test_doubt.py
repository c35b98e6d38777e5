"""Doubt is stated in every mode of deformation, inside and beyond what a test has seen."""

import dataclasses
import json

import jax
import numpy as np
import pytest
import xarray as xr

from hypernode.evaluation.doubt import ASKED, REACHES, doubts, judge_modes, judge_volume
from hypernode.evaluation.thresholds import SETTINGS
from hypernode.identification.open_laws import OpenLaw
from hypernode.material.basis_file import basis_content
from hypernode.material.domain import Domain
from hypernode.material.domain_file import domain_content
from hypernode.material.open_files import open_content, open_materials
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.storage.netcdf import SYNTHETIC_UNITS
from hypernode.verdict import Level
from tests.evaluation.files import grid, square_mesh

MESH, LARGEST = square_mesh(3), 1.2
CELLS = len(MESH.cells)
BASIS, WIDER = ConvexBasis((), 1.0), ConvexBasis(("J",), 1.0)


def cells(*params):
    return np.tile(np.array(params)[:, None, None], (1, 1, CELLS))


def constrained(area=0.0, level=0.02):
    """A neo-Hookean field, two samples whose level is off, and two of a law whose area costs more by ``area``."""
    best = cells(0.0)
    content, kind = basis_content(BASIS, best)
    seen, measures = domain_content(Domain.of(np.stack([np.diag([LARGEST, s]) for s in (0.8, 1.0, LARGEST)]), False))
    posterior = np.stack([best + level, best - level], axis=1)
    other = np.stack([cells(0.0, np.log1p(area), np.log1p(1.0))] * 2, axis=1)
    opened, laws = open_content([OpenLaw("J", WIDER, other, 0.3)])
    content |= {"posterior.log_level": (("posterior_sample", "subcell", "cell"), posterior[0]), **opened}
    content["deformation_seen"] = (("deformation_measure", "bound"), seen["deformation_seen"])
    attributes = {key: json.dumps(value) for key, value in measures.items()}
    return xr.Dataset(grid(MESH) | content, attrs=kind | laws | attributes | {"units": json.dumps(SYNTHETIC_UNITS)})


def of(field, level=0.0):
    with jax.enable_x64(True):
        return doubts({"constrained": field, "material": field}, MESH.centres, LARGEST, level)


@pytest.mark.parametrize(("force", "factor"), [(None, 1.0), (0.4, 1.0), (2.5, 2.5)])
def test_doubt_is_as_much_larger_as_forces_of_left_out_steps_are_missed(force, factor):
    plain, missed = constrained(), constrained()
    missed.attrs["left_out"] = json.dumps({"force": force})
    for one, other in zip(of(plain), of(missed), strict=True):
        assert other.total == pytest.approx(factor * one.total, rel=1e-9)


def test_every_mode_is_asked_for_at_every_stretch_and_what_is_beyond_is_said():
    found = of(constrained())
    assert [(each.mode, each.stretch) for each in found] == [
        (mode, pytest.approx(1.0 + reach * 0.2)) for mode in ASKED for reach in REACHES
    ]
    inside = {(each.mode, round(each.stretch, 2)): each.inside for each in found}
    assert inside["equibiaxial", 1.2] and inside["strip_x", 1.1]
    assert not inside["equibiaxial", 1.3]


def test_samples_that_are_off_by_a_share_leave_that_share_open_in_every_mode():
    for each in of(constrained(level=0.02), level=0.03):
        assert each.spread == pytest.approx(0.02, rel=1e-6)
        assert each.networks == pytest.approx(0.0, abs=1e-12)
        assert each.total == pytest.approx(np.hypot(np.hypot(0.02, 0.03), each.other_laws), rel=1e-6)


def test_a_volume_that_a_pull_does_not_tell_is_doubt_where_the_area_changes():
    by_mode = {each.mode: each.other_laws for each in of(constrained(area=1.0)) if each.stretch == pytest.approx(1.2)}
    assert by_mode["equibiaxial"] > 0.2
    assert by_mode["shear"] < 0.01
    told = judge_modes(of(constrained(area=1.0)), SETTINGS.spread)
    assert told.level is Level.PASSED
    assert "says little of equibiaxial" in told.sentence and "laws with J" in told.sentence


@pytest.mark.parametrize(("spread", "level"), [(0.05, Level.PASSED), (0.2, Level.WARNED), (0.9, Level.FAILED)])
def test_a_mode_that_the_test_has_made_must_be_told_by_its_own_law(spread, level):
    begun = of(constrained())
    found = [dataclasses.replace(each, spread=spread, inside=each.mode == "strip_y") for each in begun]
    assert judge_modes(found, SETTINGS.spread).level is level
    beyond = [dataclasses.replace(each, inside=False) for each in found]
    assert judge_modes(beyond, SETTINGS.spread).level is Level.PASSED


def test_what_cannot_be_told_of_the_volume_is_said():
    field = constrained(area=1.0).assign_attrs(volume_compared="true")
    assert "cannot be told" in judge_volume(field, of(field)).sentence
    field = constrained(area=0.0).assign_attrs(volume_compared="true")
    assert judge_volume(field, of(field)).sentence.startswith("The volume is kept")
    assert judge_volume(constrained(area=0.0), of(field)).level is Level.NOT_JUDGED


def test_laws_are_read_as_they_were_written():
    ((term, (material, count)),) = open_materials(constrained(area=1.0)).items()
    F = np.tile(np.diag([1.2, 1.2]), (2 * CELLS, 1, 1))
    direct = WIDER.stress(np.moveaxis(F, 0, -1), cells(0.0, np.log1p(1.0), np.log1p(1.0))[:, 0, :1])
    assert (term, count) == ("J", 2)
    assert np.asarray(material.stress(np.tile(MESH.centres, (2, 1)), F))[5] == pytest.approx(np.asarray(direct)[..., 5])


def test_a_method_without_samples_knows_no_doubt():
    field = constrained().drop_vars("posterior.log_level")
    assert of(field) == []
    assert judge_modes([], SETTINGS.spread).level is Level.NOT_JUDGED
