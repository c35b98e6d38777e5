"""A law at points: whatever their number, and whatever the size of the blocks in which they are asked."""

import numpy as np
import pytest

from hypernode.identification import points
from hypernode.identification.points import FEW, SMALL_BLOCK, Points
from hypernode.mechanics.convex_basis import ConvexBasis

LAW = ConvexBasis(("fibre",), 0.4)


def drawn(count):
    random = np.random.default_rng(count)
    F = np.eye(2)[:, :, None] + random.normal(0.0, 0.05, (2, 2, count))
    return F, LAW.start[:, None] + random.normal(0.0, 0.1, (len(LAW.start), count))


@pytest.mark.parametrize("count", [1, SMALL_BLOCK, SMALL_BLOCK + 1, FEW])
def test_few_points_answer_in_small_blocks_as_in_large_ones(count, monkeypatch):
    given = drawn(count)
    few = Points(LAW).all(*given)
    monkeypatch.setattr(points, "FEW", 0)
    for small, large in zip(few, Points(LAW).all(*given), strict=True):
        assert small.shape[-1] == count
        np.testing.assert_allclose(small, large, rtol=1e-14, atol=1e-15)


def test_each_of_many_points_answers_as_it_does_alone():
    F, params = drawn(FEW + 1)
    many = Points(LAW).all(F, params)
    for k in (0, FEW):
        for one, all_of_them in zip(Points(LAW).all(F[..., [k]], params[:, [k]]), many, strict=True):
            np.testing.assert_allclose(one[..., 0], all_of_them[..., k], rtol=1e-14, atol=1e-15)
