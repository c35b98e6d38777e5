"""Coats of materials and the lines between them."""

import dataclasses

import numpy as np
import pytest

from hypernode.fem.mesh import rectilinear
from hypernode.fem.refinement import refine
from hypernode.identification import priors
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.lines import Lines
from hypernode.identification.points import Points
from hypernode.identification.sheet import Sheet
from hypernode.mechanics.convex_basis import ConvexBasis

GRID = rectilinear(np.arange(11.0), np.arange(11.0))
X, Y = GRID.nodes.T
POINTS = Points(ConvexBasis((), 0.5))


def coats(*distances, subcells=1):
    refinement = refine(GRID, subcells)
    materials = np.arange(len(distances) + 1.0)[:, None]
    return Interfaces(Lines.of(GRID, refinement), materials, np.array(distances).reshape(len(distances), len(X)))


def test_a_later_coat_hides_an_earlier_one():
    found = coats(X - 3.0, X - 6.0).labels().reshape(10, 10)
    assert (found[:, :3] == 0).all() and (found[:, 3:6] == 1).all() and (found[:, 6:] == 2).all()


def test_materials_that_are_nowhere_are_left_out_when_distances_are_measured_anew():
    everywhere, nowhere = np.ones_like(X), -np.ones_like(X)
    for field, kept in (
        (coats(X - 3.0, nowhere, X - 6.0), [0, 1, 3]),
        (coats(X - 3.0, everywhere, X - 6.0), [2, 3]),
        (coats(nowhere), [0]),
        (coats(everywhere), [1]),
    ):
        found = field.measured_anew(1)
        assert found.materials.ravel().tolist() == kept and len(found.distances) == len(kept) - 1
        np.testing.assert_array_equal(found.materials[found.labels()], field.materials[field.labels()])


def test_every_region_pays_for_its_place_and_a_cell_that_touches_one_does_not_begin_another():
    discs = np.maximum(1.6 - np.hypot(X - 3.0, Y - 3.0), 1.6 - np.hypot(X - 8.0, Y - 8.0))
    one, two = coats(1.6 - np.hypot(X - 3.0, Y - 3.0)), coats(discs)
    assert coats().places == 0.0
    assert two.places == pytest.approx(2.0 * one.places) and one.places == pytest.approx(np.log(100.0))
    options = one.options()
    begins = np.zeros(100, bool)
    begins[options.cell[one.dearer(options) > 0.0]] = True
    x, y = GRID.centres.T
    # All cells of the disc touch others, and so do those around it.
    assert not begins[np.hypot(x - 3.0, y - 3.0) < 2.0].any() and begins[np.hypot(x - 3.0, y - 3.0) > 3.5].all()


def area_of(field, material):
    """Share of the sheet."""
    of, _ = field.cells()
    whole = np.bincount(of.cell, minlength=len(of.one)) == 0
    pieces = of.weight * ((of.first == material) * of.share + (of.second == material) * (1.0 - of.share))
    return ((of.one == material)[whole].sum() + pieces.sum()) / len(of.one)


def test_a_line_cuts_cells_by_their_shares_on_any_mesh():
    for subcells in (1, 2):
        assert np.isclose(area_of(coats(X - 4.3, subcells=subcells), 1), 0.57)


@pytest.mark.parametrize("subcells", [1, 2])
def test_where_lines_cross_every_material_has_its_area(subcells):
    field = coats(X - 4.3, Y - 6.2, subcells=subcells)
    for material, area in enumerate((0.43 * 0.62, 0.57 * 0.62, 0.38)):
        assert np.isclose(area_of(field, material), area)


def forces(field, u):
    of, _ = field.cells()
    return Sheet(field.lines.fine.mesh, POINTS, np.ones(len(of.one))).response(u, of)[0]


@pytest.mark.parametrize("subcells", [1, 2])
def test_forces_change_with_every_number_as_their_derivative_says(subcells):
    field = coats(0.3 + 0.8 * (X - 4.6) + 0.6 * (Y - 4.5), 0.6 * (X - 5.2) - 0.8 * (Y - 5.4), subcells=subcells)
    mesh = field.lines.fine.mesh
    u = 0.1 * mesh.nodes + 0.01 * np.random.default_rng(3).normal(size=mesh.nodes.shape)
    of, _ = field.cells()
    moves = field.moves(1.3)
    sheet = Sheet(mesh, POINTS, np.ones(len(of.one)))
    found, y, h = field.loads(sheet, u, moves).toarray(), field.numbers(moves), 1e-6
    for number, unit in enumerate(np.eye(len(y))):
        more, less = (forces(field.at(y + sign * h * unit, moves), u) for sign in (1.0, -1.0))
        np.testing.assert_allclose(found[:, number], (more - less) / (2.0 * h), atol=2e-6)


@pytest.mark.parametrize("subcells", [1, 2])
def test_forces_follow_a_gradual_change_as_their_derivative_says(subcells):
    field = coats(X - 4.6, subcells=subcells).changing(0.1 * np.arange(100.0) % 7, priors.GRADUAL_BENDS[0])
    mesh = field.lines.fine.mesh
    u, moves = 0.1 * mesh.nodes, field.moves(1.3)
    of, _ = field.cells()
    sheet = Sheet(mesh, POINTS, np.ones(len(of.one)))
    found, y, h = field.loads(sheet, u, moves).toarray(), field.numbers(moves), 1e-6
    for number, unit in enumerate(np.eye(len(y))):
        more, less = (forces(field.at(y + sign * h * unit, moves), u) for sign in (1.0, -1.0))
        np.testing.assert_allclose(found[:, number], (more - less) / (2.0 * h), atol=2e-6)


def test_forces_follow_a_law_that_changes_with_the_stiffness_as_their_derivative_says():
    lines, points = Lines.of(GRID, refine(GRID, 2)), Points(ConvexBasis(("I1_squared",), 0.1))
    field = Interfaces.homogeneous(lines, np.array([0.1, 0.3])).changing(
        0.1 * np.arange(100.0) % 7, priors.GRADUAL_BENDS[0]
    )
    field = dataclasses.replace(field, turn=np.array([0.2]))
    mesh = lines.fine.mesh
    u = 0.1 * mesh.nodes + 0.01 * np.random.default_rng(3).normal(size=mesh.nodes.shape)
    sheet = Sheet(mesh, points, np.ones(len(mesh.cells)))
    found, y, h = field.loads(sheet, u, []).toarray(), field.numbers([]), 1e-6
    assert found.shape[1] == len(y)
    for number, unit in enumerate(np.eye(len(y))):
        more, less = (sheet.response(u, field.at(y + sign * h * unit, []).cells()[0])[0] for sign in (1.0, -1.0))
        np.testing.assert_allclose(found[:, number], (more - less) / (2.0 * h), atol=2e-6)
    at_cells = field.by_cell()
    np.testing.assert_allclose(at_cells[1] - 0.3, 0.2 * (1.0 - np.exp(0.1 - at_cells[0])))


def test_a_gradual_change_is_about_the_one_that_was_given():
    wanted = 0.3 * np.sin(0.2 * GRID.nodes[GRID.cells].mean(axis=1)[:, 0])
    assert np.abs(coats().changing(wanted, priors.GRADUAL_BENDS[0]).grid_factor() - wanted).max() < 0.1


def test_nothing_jumps_where_a_line_leaves_a_cell_that_another_cuts():
    u = 0.1 * GRID.nodes + 0.01 * np.random.default_rng(3).normal(size=GRID.nodes.shape)
    for distance in (X - 5.0, Y - 5.0):
        for other in (X + Y - 10.3, Y - X - 0.3):
            for one in ((distance + 1e-7, other), (other, distance + 1e-7)):
                moved = [each if each is other else each - 2e-7 for each in one]
                assert np.abs(forces(coats(*one), u) - forces(coats(*moved), u)).max() < 1e-4


def test_two_coats_as_one_cover_what_both_did():
    field = coats(X - 3.0, X - 6.0, Y - 7.0)
    before = field.labels()
    for one, other in ((0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3)):
        after = field.merged(one, other)
        expected = field.materials[np.where(before == other, one, before), 0]
        np.testing.assert_array_equal(after.materials[after.labels(), 0], expected)


def test_numbers_of_a_field_give_it_back():
    field = coats(X - 3.2, Y - 6.1)
    moves = field.moves(1.3)
    again = field.at(field.numbers(moves), moves)
    np.testing.assert_array_equal(again.distances, field.distances)
    np.testing.assert_array_equal(again.materials, field.materials)


@pytest.mark.parametrize("stretch", [1.3, 2.0])
def test_a_stiff_disc_in_a_compliant_sheet_is_in_equilibrium_however_far_the_guess_is(stretch):
    field = coats(3.0 - np.hypot(X - 5.0, Y - 5.0))
    of = dataclasses.replace(field.cells()[0], materials=np.array([[0.0], [4.0]]))
    sheet, inside = Sheet(GRID, POINTS, np.ones(len(of.one))), (X > 0.0) & (X < 10.0) & (Y > 0.0) & (Y < 10.0)
    free = np.flatnonzero(np.repeat(inside, 2))

    def reached(guess):
        return sheet.equilibrium(guess, free, of, 1e-9)[0]

    near = np.zeros_like(GRID.nodes)
    for load in np.arange(1.0, 11.0) / 10.0:
        near[~inside] = load * (stretch - 1.0) * GRID.nodes[~inside]
        near = reached(near)
    # The homogeneous sheet stretches the disc as the rest, and a whole step from there turns cells inside out.
    np.testing.assert_allclose(reached((stretch - 1.0) * GRID.nodes), near, atol=1e-6)
