"""Compression of a sheet is said, and a sheet in tension has none."""

import jax.numpy as jnp
import numpy as np
import pytest

from hypernode.evaluation.compression import COUNTS, judge_compression, score_compression
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.verdict import Level

BASIS = ConvexBasis((), 1.0)


def scored(*gradients):
    """A sheet of one step that has each of these F in as many cells."""
    F = np.array([np.repeat(np.array(gradients, float), 10, axis=0)])
    params = jnp.zeros((1, F.shape[1]))
    P = np.moveaxis(np.asarray(BASIS.stress(jnp.asarray(np.moveaxis(F[0], 0, -1)), params)), -1, 0)
    return score_compression(F, P[None]).summary


PULLED, FREE = np.diag([1.0, 1.2]), np.diag([1.2**-0.5, 1.2])


def test_a_sheet_that_is_pulled_is_not_compressed():
    found = scored(PULLED, FREE)
    assert found["compressed_share"] == 0.0 and found["compression"] < COUNTS
    assert judge_compression(found).sentence.startswith("No part of the sheet is compressed")


def test_where_a_side_contracts_by_more_than_a_free_one_the_sheet_is_compressed():
    found = scored(PULLED, PULLED, PULLED, np.diag([1.2**-0.5 - 0.05, 1.2]))
    assert found["compressed_share"] == 0.25 and found["compression"] > COUNTS
    said = judge_compression(found)
    assert said.level is Level.PASSED and said.sentence.startswith("25 % of the sheet is compressed")


def test_a_step_at_rest_is_no_compression_for_its_noise():
    random = np.random.default_rng(0)
    rest = np.eye(2) + 1e-4 * random.normal(size=(40, 2, 2))
    F = np.array([rest, np.tile(FREE, (40, 1, 1))])
    params = jnp.zeros((1, 40))
    P = [np.moveaxis(np.asarray(BASIS.stress(jnp.asarray(np.moveaxis(f, 0, -1)), params)), -1, 0) for f in F]
    assert score_compression(F, np.array(P)).summary["compressed_share"] == 0.0


def test_turning_a_sheet_changes_no_compression():
    Q = np.array([[0.8, -0.6], [0.6, 0.8]])
    shear = np.array([[1.0, 0.2], [0.0, 1.0]])
    assert scored(Q @ shear)["compression"] == pytest.approx(scored(shear)["compression"], rel=1e-6)
    assert scored(shear)["compressed_share"] == 1.0


def test_cells_without_a_stress_count_as_none():
    F = np.tile(np.eye(2), (2, 4, 1, 1))
    assert score_compression(F, np.full_like(F, np.nan)).summary == {"compressed_share": 0.0, "compression": 0.0}
    assert judge_compression({}).level is Level.NOT_JUDGED
