"""The level of the stress is as uncertain as its inputs, and as what nobody sees of the sheet."""

import itertools
import json

import numpy as np
import pytest
import xarray as xr

from hypernode.data.seen_share import section
from hypernode.evaluation.conditioning import posterior_uncertainty
from hypernode.evaluation.equilibrium import nodal_forces
from hypernode.evaluation.level_budget import (
    SHARE,
    judge_level,
    level_beside_samples,
    level_budget,
    table,
)
from hypernode.evaluation.thresholds import SETTINGS
from hypernode.fem.factors import factorise
from hypernode.fem.mesh import rectilinear
from hypernode.fem.solver import EquilibriumSolver
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.verdict import Level

CELLS, STRETCH = 30, 1.05
SHARES = (0.6, 0.8, 1.0)
LINES = np.linspace(0.0, 1.0, CELLS + 1)
SHAPES = {
    "disc": lambda X: ((X - 0.5) ** 2).sum(axis=1) < 0.2**2,
    "disc beside the middle": lambda X: ((X - [0.35, 0.4]) ** 2).sum(axis=1) < 0.18**2,
    "stripe": lambda X: np.abs(X[:, 0] - 0.5) < 0.1,
    "stripe beside the middle": lambda X: np.abs(X[:, 0] - 0.4) < 0.15,
    "oblique stripe": lambda X: np.abs(X[:, 0] - X[:, 1]) < 0.12,
}
CONTRASTS = (1.0, 2.0, 5.0, 0.2)


@pytest.fixture(scope="module")
def clamped():
    """(stress of a cell, force) of whole sheets that are clamped and pulled along y, by shape and contrast."""
    mesh, basis = rectilinear(LINES, LINES), ConvexBasis((), 1.0)
    start = np.tile(basis.start, (len(mesh.cells), 1))
    solver = EquilibriumSolver(mesh, lambda F, p: basis.stress(F, p["params"]), {"params": start})
    held = np.flatnonzero(np.repeat(mesh.on_edge("bottom") | mesh.on_edge("top"), 2))
    pulled = np.where(mesh.on_edge("top")[:, None], [0.0, STRETCH - 1.0], 0.0)
    free = np.setdiff1d(np.arange(pulled.size), held)
    found = {}
    for shape, contrast in itertools.product(SHAPES, CONTRASTS):
        params = start.copy()
        params[:, 0] += np.log(contrast) * SHAPES[shape](mesh.centres)
        solver.set_parameters({"params": params})
        K = solver.tangent(np.zeros_like(pulled))[1]
        guess = pulled.copy().ravel()
        guess[free] = -factorise(K[free][:, free]).solve((K @ pulled.ravel())[free])
        reached = solver.newton(guess.reshape(-1, 2), held)
        F = np.eye(2) + np.einsum("caJ,cai->ciJ", mesh.gradient_operator(), reached.u[mesh.cells])
        P = np.moveaxis(np.asarray(basis.stress(np.moveaxis(F, 0, -1), params.T)), -1, 0)
        found[shape, contrast] = (
            P,
            float(reached.u is not None and reached.force.reshape(-1, 2)[mesh.on_edge("top"), 1].sum()),
        )
    return found


def middle(P, share):
    """(mesh of the points that are seen, stress of its cells) of the middle of a sheet, as wide as a share of it."""
    dropped = round(0.5 * (1.0 - share) * CELLS)
    lines = LINES[dropped : CELLS + 1 - dropped]
    grid = P.reshape(CELLS, CELLS, 2, 2)[dropped : CELLS - dropped, dropped : CELLS - dropped]
    return rectilinear(lines, lines), grid.reshape(-1, 2, 2)


def level_error(P, force, share):
    """(by what the force of the sheet is missed, its uncertainty) where the stress of the seen middle is known."""
    mesh, seen = middle(P, share)
    nodal = nodal_forces(mesh, seen[None])[0]
    top, bottom = (nodal[mesh.on_edge(edge), 1].sum() for edge in ("top", "bottom"))
    found = section(mesh, seen, 1, share, True)
    return 0.5 * (top - bottom) / (found.carried * share * force) - 1.0, found.uncertainty


def test_the_force_of_a_sheet_seen_in_part_is_within_two_spreads_in_nine_of_ten(clamped):
    #: Finite elements of this size, and a load cell, are known to a hundredth.
    least = 0.01
    errors = np.array([level_error(*each, share) for each in clamped.values() for share in SHARES])
    within = np.abs(errors[:, 0]) <= 2.0 * np.hypot(errors[:, 1], least)
    assert within.mean() >= 0.9


def test_where_four_fifths_are_seen_the_force_is_missed_by_two_per_cent_and_its_spread_is_five_at_most(clamped):
    told = np.array([level_error(*each, 0.8) for each in clamped.values()])
    assert np.abs(told[:, 0]).max() <= 0.02 and told[:, 1].max() <= 0.05


def test_a_rim_that_differs_from_what_is_beside_it_says_less_of_what_is_not_seen(clamped):
    told = {shape: level_error(*clamped[shape, 5.0], 0.6)[1] for shape in SHAPES}
    assert told["stripe"] > 0.1 > told["disc"]


def test_what_is_beside_a_stripe_is_not_as_stiff_as_the_mean(clamped):
    P, force = clamped["stripe", 5.0]
    mesh, seen = middle(P, 0.6)
    plain = nodal_forces(mesh, seen[None])[0][mesh.on_edge("top"), 1].sum() / (0.6 * force) - 1.0
    assert plain > 0.25 and abs(level_error(P, force, 0.6)[0]) < plain / 5.0


@pytest.mark.parametrize("share", [0.3, 0.6, 0.9])
def test_a_uniform_pull_is_carried_by_the_width(share):
    mesh = rectilinear(LINES, LINES)
    found = section(mesh, np.tile(np.diag([0.0, 1.0]), (len(mesh.cells), 1, 1)), 1, share, True)
    assert found.carried == pytest.approx(1.0) and found.uncertainty == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("free", "strips"), [(True, 0.9), (False, 1.0)])
def test_free_strips_carry_less_by_half_of_the_stress_across_their_rim(free, strips):
    mesh = rectilinear(LINES, LINES)
    found = section(mesh, np.tile(np.diag([0.2, 1.0]), (len(mesh.cells), 1, 1)), 1, 0.5, free)
    assert found.carried == pytest.approx(1.0 / (0.5 + 0.5 * strips))


def measured(share, **attributes):
    """Two steps of the middle of a uniform sheet under 1 and 2 N/mm."""
    mesh = rectilinear(LINES, LINES)
    force = np.full((2, 4, 2), np.nan)
    force[:, 2, 1], force[:, 3, 1] = [-1.0, -2.0], [1.0, 2.0]
    held = np.zeros((2, 4, 2))
    held[:, 2:] = 1.0
    return xr.Dataset(
        {
            "X": (("node", "i"), mesh.nodes),
            "cells": (("cell", "vertex"), mesh.cells),
            "corners": (("corner", "i"), np.stack([mesh.lower, mesh.upper])),
            "load_case": ("load_step", np.zeros(2, int)),
            "H": (("load_step", "i", "J"), np.array([[[0, 0], [0, 0.1]], [[0, 0], [0, 0.2]]])),
            "edge_force": (("load_step", "edge", "i"), force),
            "relaxation": ("load_step", np.ones(2)),
            "edge_constrained": (("load_step", "edge", "i"), held),
            "relative_thickness": ("cell", np.ones(len(mesh.cells))),
            "force_relaxation_uncertainty": ("load_step", np.array([0.03, 0.03])),
        },
        attrs={
            "thickness": 1.0,
            "outline": "cut",
            "forces": "measured",
            "force_uncertainty": 0.01,
            "force_gain_uncertainty": 0.01,
            "force_offset_uncertainty": 0.08,
            "thickness_uncertainty": 0.02,
            "pixel_size_uncertainty": 0.005,
            "seen_share": json.dumps([[share, 1.0]]),
            **attributes,
        },
    )


def test_parts_add_by_squares_and_a_zero_weighs_more_in_small_forces():
    stress = np.tile(np.diag([0.0, 1.0]), (2, CELLS**2, 1, 1))
    budget = level_budget(measured(0.6), stress)
    parts = {part.name: part.level for part in budget.parts}
    # The zero is 0.08 of 2 N/mm: 0.16 of the first force, and 0.08 of the second.
    assert parts == pytest.approx(
        {
            "zero": 0.12,
            "gain": 0.01,
            "thickness": 0.02,
            "pixel size": 0.0,
            SHARE: 0.0,
            "preload": 0.0,
            "camera motion": 0.0,
            "relaxation": 0.03,
            "pairing": 0.0,
        }
    )
    assert budget.level == pytest.approx(np.sqrt(0.12**2 + 0.01**2 + 0.02**2 + 0.03**2))
    total = {"input": "level", "type": "", "prior": None, "posterior": budget.level, "level": budget.level}
    assert table(budget)[-1] == {**total, "told_by": ""}


def pulled(strains, **attributes):
    """A test of one load case with so many steps, whose force is in proportion to the strain."""
    strains = np.asarray(strains)
    force = np.full((len(strains), 4, 2), np.nan)
    force[:, 2, 1], force[:, 3, 1] = -strains, strains
    record, one = measured(1.0, **attributes), np.zeros(len(strains))
    held = np.repeat(record["edge_constrained"].values[:1], len(strains), axis=0)
    return record.drop_dims("load_step").assign(
        load_case=("load_step", one.astype(int)),
        H=(("load_step", "i", "J"), strains[:, None, None] * np.diag([0.0, 1.0])),
        edge_force=(("load_step", "edge", "i"), force),
        relaxation=("load_step", one + 1.0),
        edge_constrained=(("load_step", "edge", "i"), held),
        force_relaxation_uncertainty=("load_step", one),
    )


def budget_of(strains, **attributes):
    stress = np.tile(np.diag([0.0, 1.0]), (len(strains), CELLS**2, 1, 1))
    return level_budget(pulled(strains, **attributes), stress)


def test_forces_tell_of_a_zero_and_of_nothing_that_all_of_them_share():
    steps = np.linspace(0.04, 0.2, 5)
    budget = budget_of(steps)
    zero = budget.of("zero")
    assert zero.prior == 0.08 and zero.posterior < 0.5 * zero.prior and zero.told_by == "forces"
    for name in ("gain", "thickness", "pixel size"):
        part = budget.of(name)
        assert part.posterior == part.prior and not part.told_by
    assert "The test tells of zero." in judge_level(budget, SETTINGS.level).sentence
    # Three forces may bend in any way: they tell nothing. A zero that is known as well as a force is not told either.
    for alike in (budget_of(steps[:3]), budget_of(steps, force_offset_uncertainty=0.001)):
        zero = alike.of("zero")
        assert zero.posterior == pytest.approx(zero.prior, rel=0.01) and not zero.told_by


def test_the_posterior_of_a_zero_is_how_far_its_best_estimate_is_off():
    """Of sheets with any level and bend, by the estimate of least variance."""
    strains, random = np.linspace(0.04, 0.2, 5), np.random.default_rng(0)
    by_zero, free = strains[-1] / strains, (strains[:, None] / strains[-1]) ** (0, 1, 2)
    zero = 0.08 * random.normal(size=4000)
    coefficients, noise = random.normal(size=(4000, 3)), 0.01 * random.normal(size=(4000, 5))
    seen = zero[:, None] * by_zero + coefficients @ free.T + noise
    rows = np.vstack([np.column_stack([by_zero, free]) / 0.01, [1.0 / 0.08, 0.0, 0.0, 0.0]])
    found = np.linalg.lstsq(rows, np.vstack([seen.T / 0.01, np.zeros(4000)]), rcond=None)[0][0]
    assert budget_of(strains).of("zero").posterior == pytest.approx(np.std(found - zero), rel=0.05)


def test_what_is_found_from_the_test_alone_has_no_prior():
    rows = {row["input"]: row for row in table(budget_of([0.05, 0.1], preload=0.01))}
    assert rows["preload"] == {
        **{"input": "preload", "type": "A", "prior": None, "posterior": 0.01, "level": 0.01, "told_by": "record"}
    }
    assert rows["thickness"]["type"] == "B" and rows["thickness"]["posterior"] == rows["thickness"]["prior"] == 0.02


def test_steps_whose_force_is_open_tell_less_of_the_level():
    stress = np.tile(np.diag([0.0, 1.0]), (2, CELLS**2, 1, 1))
    record = measured(0.6).assign(force_pairing_uncertainty=("load_step", np.array([1.0, 0.1])))
    record["force_relaxation_uncertainty"][:] = 0.0
    parts = {part.name: part.level for part in level_budget(record, stress).parts}
    # The first step weighs a hundredth of the second: 0.11, and not the 0.71 of their root mean square.
    assert parts["pairing"] == pytest.approx(0.109, abs=0.002)
    assert parts["zero"] == pytest.approx(0.08 * (0.01 * 2.0 + 0.99), rel=0.01)


def test_doubt_has_the_parts_of_the_cross_section_that_no_sample_knows():
    stress = np.tile(np.diag([0.0, 1.0]), (2, CELLS**2, 1, 1))
    assert level_beside_samples(level_budget(measured(0.6), stress)) == pytest.approx(0.02)
    assert level_beside_samples(level_budget(measured(1.0), stress)) == pytest.approx(np.hypot(0.02, 0.005))
    assert level_beside_samples(None) == 0.0


def test_a_preload_and_a_camera_that_comes_nearer_make_strains_wrong():
    stress = np.tile(np.diag([0.0, 1.0]), (2, CELLS**2, 1, 1))
    record = measured(0.6, preload=0.015, camera_distance_uncertainty=1e-3)
    parts = {part.name: part.level for part in level_budget(record, stress).parts}
    # A thousandth is a hundredth of the first strain, 0.1, and half of that of the second.
    assert parts["preload"] == 0.015 and parts["camera motion"] == pytest.approx(0.0075)
    assert level_beside_samples(level_budget(record, stress)) == pytest.approx(np.hypot(0.02, np.hypot(0.015, 0.0075)))


def test_where_all_is_seen_the_section_is_measured_in_pixels():
    stress = np.tile(np.diag([0.0, 1.0]), (2, CELLS**2, 1, 1))
    assert level_budget(measured(1.0), stress).of("pixel size").level == 0.005


def test_a_verdict_says_what_the_share_costs():
    mesh = rectilinear(LINES, LINES)
    stiffer = 1.0 + 4.0 * (np.abs(mesh.centres[:, 0] - 0.3) < 0.1)
    stress = stiffer[None, :, None, None] * np.tile(np.diag([0.0, 1.0]), (2, CELLS**2, 1, 1))
    said = judge_level(level_budget(measured(0.6, force_offset_uncertainty=0.001), stress), SETTINGS.level)
    assert said.level is not Level.PASSED and "cover 60 % of the width" in said.sentence
    assert said.sentence.index(SHARE) < said.sentence.index("relaxation") < said.sentence.index("gain")


def test_a_level_that_is_a_convention_has_no_budget():
    assert level_budget(measured(0.6, forces="assumed"), np.zeros((2, CELLS**2, 2, 2))) is None
    assert judge_level(None, SETTINGS.level).level is Level.NOT_JUDGED


@pytest.mark.parametrize(("prior", "expected"), [(0.0, 0.0), (0.001, 0.0)])
def test_forces_without_errors_tell_a_zero_exactly_and_a_known_zero_stays_known(prior, expected):
    by_zero = np.array([4.0, 2.0, 1.5, 1.2, 1.0])
    free = np.linspace(0.2, 1.0, 5)[:, None] ** (0, 1, 2)
    assert posterior_uncertainty(prior, by_zero, np.zeros((5, 5)), free) == pytest.approx(expected, abs=1e-9)
