"""Pictures observed without points between: their information takes the place of displacements and their noise."""

import numpy as np
import pytest

from hypernode.config.correlation import Correlation
from hypernode.config.methods import Constrained
from hypernode.config.pictures import Pictures
from hypernode.data.coarsening import coarsened
from hypernode.data.information import Information
from hypernode.data.measurement import mesh_of
from hypernode.fem.interpolation import NodalField
from hypernode.fem.mesh import rectilinear
from hypernode.fem.refinement import refine
from hypernode.fem.transfer import transfer
from hypernode.identification import numerics
from hypernode.identification.problem import field_problem
from hypernode.identification.strategy import identify
from hypernode.mechanics.loads import make_load
from hypernode.pictures.finite_elements import on_sheet, seen_by_elements
from hypernode.pictures.photograph import followed, light, recorded, sheet_mask
from hypernode.pictures.speckle import Pattern, sprayed
from hypernode.pictures.view import view_of
from tests.sheets import sheet, square

SETTINGS = Constrained(terms=["I1_squared"])
NAMES = {
    "grey_X": ("grey_node", "i"),
    "grey_cells": ("grey_cell", "vertex"),
    "grey_u": ("load_step", "grey_node", "i"),
    "grey_information": ("load_step", "grey_cell", "element_dof", "other_dof"),
    "grey_pull": ("load_step", "grey_cell", "element_dof"),
}


def with_information(data, information):
    each = information.to_variables()
    return data.assign({name: (dims, each[name]) for name, dims in NAMES.items()})


def of_points(data, sigma, divided=1):
    """The same test, whose nodes, or those of a finer mesh, are as well known and as independent as points are."""
    mesh = refine(mesh_of(data), divided)
    nodes, cells = mesh.mesh.nodes, mesh.mesh.cells
    share = 1.0 / np.bincount(cells.ravel(), minlength=len(nodes))
    matrix = np.repeat(share[cells], 2, axis=1)[:, :, None] * np.eye(8) / sigma**2
    u = np.stack([mesh.interpolation @ each for each in data["u_measured"].values[0]])
    steps = len(u)
    # Linearised elsewhere, and pulled from there to where it is.
    away = np.random.default_rng(1).normal(0.0, sigma, u.shape)
    pull = np.einsum("ckl,scl->sck", matrix, -away[:, cells].reshape(steps, len(cells), 8))
    return with_information(data, Information(mesh.mesh, u + away, np.tile(matrix, (steps, 1, 1, 1)), pull)), share


def field_of(problem, params):
    params = params[transfer(problem.observations.grid, problem.mesh).cells]
    params = params + np.random.default_rng(2).normal(0.0, 0.1, params.shape)
    return params, problem.equilibrium.states(params, problem.equilibrium.extension(params))


def test_information_of_independent_nodes_weighs_as_points_do_but_for_cells_at_prescribed_edges():
    data, mesh, params = sheet(6, square, make_load("equibiaxial", [1.1, 1.2]), noise=1e-3)
    informed, share = of_points(data, 1e-3)
    problem = field_problem(informed.assign_attrs(mesh="finer"), SETTINGS)
    _, states = field_of(problem, params)
    residuals, _ = problem.residuals(states)
    inner = ((mesh.centres > 1 / 6) & (mesh.centres < 5 / 6)).all(axis=1)
    weight = np.bincount(mesh.cells[inner].ravel(), minlength=len(mesh.nodes)) * share
    for state, residual, u, boundary in zip(
        states, residuals, data["u_measured"].values[0], problem.observations.boundaries, strict=True
    ):
        expected = weight @ ((state.u - u) ** 2).sum(axis=1)
        assert residual @ residual == pytest.approx(expected, rel=1e-6)
        assert len(residual) == len(boundary.observed) == 2 * np.count_nonzero(weight)


@pytest.mark.parametrize("subcells", [1, 2])
def test_the_adjoint_is_the_derivative_of_what_grey_levels_are_missed_by(subcells, monkeypatch):
    monkeypatch.setattr(numerics, "NEWTON_TOLERANCE", 1e-10)
    data, _, params = sheet(5, square, make_load("uniaxial_x", [1.1, 1.2]), noise=1e-3)
    informed, _ = of_points(data, 1e-3, 2)
    problem = field_problem(informed, SETTINGS, subcells)
    params, states = field_of(problem, params)
    linear = problem.linearise(params, states, problem.sigma)
    step = np.random.default_rng(3).normal(size=params.shape)

    def residuals(t):
        moved = params + t * step
        u, f = problem.residuals(problem.equilibrium.states(moved, [state.u for state in states]))
        return linear.whiten(np.concatenate([*(r / problem.sigma for r in u), f]))

    h = 1e-5
    slope = (np.sum(residuals(h) ** 2) - np.sum(residuals(-h) ** 2)) / (4.0 * h)
    assert linear.adjoint(residuals(0.0)) @ step.ravel() == pytest.approx(slope, rel=1e-5)


def test_a_coarser_grid_sees_the_same_pictures():
    data, _, _ = sheet(8, square, make_load("uniaxial_x", [1.1]), noise=1e-3)
    informed, _ = of_points(data, 1e-3, 2)
    coarse = field_problem(coarsened(informed), SETTINGS)
    assert len(coarse.mesh.cells) == 16
    # All nodes of the finer mesh but those on prescribed edges, whose cells have told them.
    assert coarse.observed == 2 * 17 * (17 - 2 * 4)
    u = coarse.observations.refinement.interpolation @ coarse.observations.u[0]
    (boundary,) = coarse.observations.boundaries
    left = (boundary.observe @ u.ravel() - boundary.seen) / coarse.sigma
    assert np.isfinite(left).all() and len(left) == coarse.observed


def test_where_no_picture_says_anything_nothing_is_observed():
    data, _, _ = sheet(4, square, make_load("uniaxial_x", [1.1]), noise=1e-3)
    informed, _ = of_points(data, 1e-3)
    blind = informed.assign(grey_information=informed["grey_information"] * 0.0, grey_pull=informed["grey_pull"] * 0.0)
    assert field_problem(blind, SETTINGS).observed == 0


def disc(X):
    return ((X - (0.52, 0.47)) ** 2).sum(axis=1) < 0.24**2


def pictures_of(data, mesh, pixels, noise):
    """(pictures, mask, view) of a sheet of one by one."""
    settings = Pictures(pixels=pixels, noise=noise, margin=10)
    u = np.concatenate([np.zeros((1, *mesh.nodes.shape)), followed(mesh, data["u_measured"].values[0])])
    view = view_of(mesh.nodes + u, 1.0 / pixels, settings.margin)
    pattern = Pattern.of(sprayed((pixels, pixels), settings.speckle), (pixels, pixels))
    grey = [light(pattern, NodalField.of(mesh, each), view, settings) for each in u]
    pictures = np.stack([recorded(each, settings, k) for k, each in enumerate(grey)])
    return pictures, sheet_mask(NodalField.of(mesh, u[0]), view), view


@pytest.mark.slow
def test_a_disc_is_identified_from_pictures_without_points_between():
    """A disc twice as stiff, 240 pixels, two grey levels of noise: its stiffness to 3 %, its area to 8 %."""
    load, side = make_load("equibiaxial", [1.06, 1.12]), Correlation(engine="finite_elements", step=10).step
    data, fine, _ = sheet(60, disc, load, terms=())
    pictures, mask, view = pictures_of(data, fine, 240, 2.0)
    seen = seen_by_elements(pictures, mask, side, 2.0)
    length, origin = view.mm_per_pixel, np.array([view.origin_column, view.origin_row])
    information = on_sheet(seen.information, length, origin)
    grid, u = on_sheet_points(seen, length, origin)
    held = np.ones((2, 4, 2))
    share = (grid.upper - grid.lower)[::-1]
    force = data["edge_force"].values * np.repeat(share, 2)[:, None]
    told = data.drop_vars([name for name in data if {"node", "cell"} & set(data[name].dims)]).assign(
        X=(("node", "i"), grid.nodes),
        cells=(("cell", "vertex"), grid.cells),
        corners=(("corner", "i"), np.stack([grid.lower, grid.upper])),
        u_measured=(("repeat", "load_step", "node", "i"), u[None]),
        noise_level=(("load_step", "i"), seen.level * length),
        noise_scatter=(("load_step", "i"), seen.noise * length),
        relative_thickness=(("cell",), np.ones(len(grid.cells))),
        edge_constrained=(("load_step", "edge", "i"), held),
        edge_force=(("load_step", "edge", "i"), force),
    )
    told = with_information(told, information).assign_attrs(outline="cut", mesh="finer", force_uncertainty=0.01)
    found = identify(told, Constrained(terms=[], iterations=30), "disc")
    mesh, stiffness = found.problem.mesh, found.params[:, 0]
    far = np.abs(np.sqrt(((mesh.centres - (0.52, 0.47)) ** 2).sum(axis=1)) - 0.24) > 0.06
    inside = disc(mesh.centres)
    ratio = np.exp(np.median(stiffness[inside & far]) - np.median(stiffness[~inside & far]))
    assert ratio == pytest.approx(2.0, rel=0.03)
    middle = 0.5 * (np.median(stiffness[inside & far]) + np.median(stiffness[~inside & far]))
    assert mesh.areas[stiffness > middle].sum() == pytest.approx(np.pi * 0.24**2, rel=0.08)


def on_sheet_points(seen, length, origin):
    """(grid of the points on the sheet, their displacement) with nodes as a measurement has them."""
    upward = np.array([1.0, -1.0]) * length
    nodes = (seen.mesh.nodes - origin) * upward
    grid = rectilinear(*(np.unique(np.round(line, 9)) for line in nodes.T))
    order = np.lexsort(np.round(nodes, 9).T)
    return grid, seen.u[:, order] * upward
