"""A law at points: each answers as it does alone, whatever the number of points that are asked together."""

import numpy as np
import pytest

from hypernode.fem.blocks import BLOCK
from hypernode.identification.points import Points
from hypernode.mechanics.convex_basis import ConvexBasis

LAW = ConvexBasis(("fibre",), 0.4)


def drawn(count):
    random = np.random.default_rng(count)
    F = np.eye(2)[:, :, None] + random.normal(0.0, 0.05, (2, 2, count))
    return F, LAW.start[:, None] + random.normal(0.0, 0.1, (len(LAW.start), count))


@pytest.mark.parametrize("count", [1, BLOCK, BLOCK + 1, 3 * BLOCK - 1])
def test_each_of_many_points_answers_as_it_does_alone(count):
    F, params = drawn(count)
    many = Points(LAW).all(F, params)
    for k in {0, count // 2, count - 1}:
        for one, all_of_them in zip(Points(LAW).all(F[..., [k]], params[:, [k]]), many, strict=True):
            assert all_of_them.shape[-1] == count
            np.testing.assert_allclose(one[..., 0], all_of_them[..., k], rtol=1e-14, atol=1e-15)
