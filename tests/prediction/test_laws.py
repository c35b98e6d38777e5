"""Laws of phases, as another sheet takes them over."""

import json

import numpy as np
import pytest
import xarray as xr

from hypernode.material.basis_file import basis_content
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.prediction.errors import PredictionError
from hypernode.prediction.laws import phase_laws
from hypernode.stages.prediction import not_passed
from hypernode.storage.netcdf import SYNTHETIC_UNITS, write
from hypernode.verdict import Criterion, Level, Verdict
from tests.evaluation.files import grid, square_mesh

MESH, BASIS = square_mesh(10), ConvexBasis(("J",), 1.0)
CELLS, SAMPLES = len(MESH.cells), 8


def field(level, area, scatter=0.01, gradual=True):
    """A field of cells without materials, whose level and area term are given, with samples of another level."""
    params = np.stack([np.broadcast_to(level, CELLS), np.broadcast_to(area, CELLS), np.full(CELLS, 0.4)])
    content, kind = basis_content(BASIS, params[:, None])
    shift = scatter * np.random.default_rng(0).normal(size=SAMPLES)
    for name, values in zip(BASIS.names, params, strict=True):
        moved = values + (shift[:, None] if name == "log_level" else np.zeros((SAMPLES, 1)))
        content[f"posterior.{name}"] = (("posterior_sample", "subcell", "cell"), moved[:, None])
    load = {"stretch": ("load_step", [1.1])}
    return xr.Dataset(
        grid(MESH) | content | load, attrs=kind | {"units": json.dumps(SYNTHETIC_UNITS), "gradual": json.dumps(gradual)}
    )


def test_a_sheet_whose_stiffness_alone_changes_gradually_has_one_law_that_scatters_as_its_places_do():
    level = -1.4 + 0.1 * np.sin(2.0 * np.pi * MESH.centres[:, 0])
    (law,) = phase_laws(field(level, 0.7), "sheet")
    assert law.best == pytest.approx([np.median(level), 0.7, 0.4])
    scatter = np.sqrt(np.mean((law.samples[:, 0] - law.best[0]) ** 2))
    assert scatter == pytest.approx(np.hypot(level.std(), 0.01), rel=0.2)
    np.testing.assert_allclose(law.samples[:, 1:], np.tile([0.7, 0.4], (SAMPLES, 1)))


def test_places_are_in_no_order_and_unlike_those_of_another_sheet():
    level = -1.4 + 0.1 * np.sin(2.0 * np.pi * MESH.centres[:, 0])
    one, other = (phase_laws(field(level, 0.7, scatter=0.0), name)[0].samples[:, 0] for name in ("one", "other"))
    again = phase_laws(field(level, 0.7, scatter=0.0), "one")[0].samples[:, 0]
    np.testing.assert_array_equal(one, again)
    np.testing.assert_allclose(np.sort(one), np.sort(other))
    assert (np.diff(one) < 0.0).any() and (one != other).any()
    assert abs(np.corrcoef(one, other)[0, 1]) < 0.9


@pytest.mark.parametrize("level", [-1.4, np.where(MESH.centres[:, 0] < 0.4, -1.4, -0.4)])
def test_a_sheet_that_is_not_said_to_change_gradually_has_no_law_whatever_its_cells_share(level):
    with pytest.raises(PredictionError, match="every cell has a material of its own"):
        phase_laws(field(level, 0.7, gradual=False), "sheet")


def test_a_field_whose_cells_have_laws_of_their_own_has_none_of_a_phase():
    area = 0.7 + 0.1 * MESH.centres[:, 1]
    with pytest.raises(PredictionError, match="every cell has a material of its own"):
        phase_laws(field(-1.4, area), "sheet")


@pytest.mark.parametrize(("level", "said"), [(Level.PASSED, 0), (Level.WARNED, 1), (Level.FAILED, 1)])
def test_a_run_that_does_not_pass_is_named_where_its_laws_predict(tmp_path, level, said):
    verdict = Verdict((Criterion("displacements", level, "Displacements are missed."),))
    write(tmp_path / "evaluation.nc", {}, "evaluation", {"verdict": verdict.stored(), "units": SYNTHETIC_UNITS})
    sentences = not_passed([tmp_path / "constrained.nc", tmp_path / "elsewhere" / "constrained.nc"])
    assert len(sentences) == said
    assert all("displacements" in each and "by more than their spread" in each for each in sentences)
