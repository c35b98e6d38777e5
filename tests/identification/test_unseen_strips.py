"""What strips beside the points carry is told by the field, and by nothing where no strip is unseen."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from hypernode.identification.unseen_strips import stress_of, with_carried_shares
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.mechanics.loads import make_load
from tests.sheets import sheet, square

LAW = ConvexBasis((), 1.0)


def found_in(data, factor, forces=1):
    """A field of neo-Hookean cells whose first column is so many times as stiff as the others."""
    parts = np.zeros((1, 1, data.sizes["cell"]))
    parts[:] = LAW.start[:, None, None]
    first = np.isclose(data["X"].values[data["cells"].values, 0].min(axis=1), 0.0)
    parts[0, 0, first] += np.log(factor)
    states = [SimpleNamespace(u=u) for u in data["u_measured"].values[0]]
    nodes = SimpleNamespace(nodes=slice(None))
    problem = SimpleNamespace(refinement=nodes, forces=[None] * forces)
    return SimpleNamespace(states=states, by_parts=parts, basis=LAW, layered=False, problem=problem)


@pytest.fixture(scope="module")
def part():
    data, _, _ = sheet(8, square, make_load("clamped_y", [1.1, 1.2]))
    return data.assign_attrs(outline="cut", seen_share="[[0.8, 1.0]]")


def carried(part, factor):
    return np.array(json.loads(with_carried_shares(part, found_in(part, factor)).attrs["carried_share"]))


def test_a_strip_beside_a_stiffer_rim_carries_more(part):
    soft, stiff = carried(part, 1.0), carried(part, 3.0)
    assert soft.shape == (2, 2) and (soft[:, 0] == 1.0).all()
    assert (stiff[:, 1] < soft[:, 1] - 0.05).all()


def test_where_all_is_seen_or_no_force_is_known_a_field_tells_nothing(part):
    assert with_carried_shares(part.assign_attrs(seen_share="[[1.0, 1.0]]"), found_in(part, 1.0)) is None
    assert with_carried_shares(part, found_in(part, 1.0, forces=0)) is None


def test_it_is_told_of_either_outline_as_an_evaluation_asks_of_either(part):
    np.testing.assert_array_equal(carried(part.assign_attrs(outline="edge"), 3.0), carried(part, 3.0))


def test_layers_of_cut_cells_count_as_layers(part):
    found = found_in(part, 1.0)
    alone = stress_of(found, part)
    found.layered, found.jump_stress = True, lambda F: np.full(F.shape, 0.25)
    np.testing.assert_allclose(stress_of(found, part), alone + 0.25)
