"""A small sheet with a stiff inclusion under load, as a measurement file would hold it."""

import functools

import numpy as np
import xarray as xr

from hypernode.fem.mesh import EDGE_NAMES, rectilinear
from hypernode.fem.solver import EquilibriumSolver, law_stress
from hypernode.identification.camera import window_average
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.synthetic.forward import resultants

SCALE = 0.4


@functools.cache
def finite_elements(cells, terms):
    """(basis, mesh, solver) of all square sheets of so many cells a side with these terms, which compile once."""
    basis = ConvexBasis(terms, SCALE)
    lines = np.linspace(0.0, 1.0, cells + 1)
    mesh = rectilinear(lines, lines)
    start = {"params": np.tile(basis.start, (len(mesh.cells), 1))}
    return basis, mesh, EquilibriumSolver(mesh, law_stress(basis), start)


def sheet(cells, inclusion, load, noise=0.0, window=0.0, terms=("I1_squared",), seed=5, values=(), inside=None):
    """A measurement, as the file would hold it, of a sheet that is stiffer by 2 to the power of ``inclusion``, 0 to 1.

    Of the basis with ``terms`` its parameters have their ``values``, pairs of name and number, or those it starts with.
    Where ``inside`` is given, those of the inclusion have these values, and it is no stiffer.
    """
    basis, mesh, solver = finite_elements(cells, tuple(terms))
    values = dict(zip(basis.names, basis.start, strict=True)) | dict(values)
    params = np.tile(list(values.values()), (len(mesh.cells), 1))
    if inside is None:
        params[:, 0] += np.log(2.0) * inclusion(mesh.centres)
    else:
        params[inclusion(mesh.centres) > 0.0] = list((values | dict(inside)).values())
    solver.set_parameters({"params": params})
    u, _ = solver.solve(load)
    force, held = np.full((len(u), 4, 2), np.nan), np.zeros((len(u), 4, 2))
    for step, field in enumerate(u):
        for edge, i in load.constrained:
            held[step, EDGE_NAMES.index(edge), i] = 1.0
        force[step] = np.where(held[step] > 0, resultants(solver, field, load), np.nan)
    measured = u + np.random.default_rng(seed).normal(0.0, noise, u.shape) if noise else u
    names = ("load_step", "node", "i")
    data = xr.Dataset(
        {
            "X": (("node", "i"), mesh.nodes),
            "cells": (("cell", "vertex"), mesh.cells),
            "corners": (("corner", "i"), np.stack([mesh.lower, mesh.upper])),
            "u_measured": (("repeat", *names), measured[None]),
            "noise_level": (("load_step", "i"), np.full((len(u), 2), noise)),
            "noise_scatter": (("load_step", "i"), np.full((len(u), 2), noise)),
            "relative_thickness": (("cell",), np.ones(len(mesh.cells))),
            "load_case": (("load_step",), np.zeros(len(u), int)),
            "stretch": (("load_step",), load.stretch),
            "H": (("load_step", "i", "J"), load.H),
            "edge_force": (("load_step", "edge", "i"), force),
            "relaxation": (("load_step",), np.ones(len(u))),
            "edge_constrained": (("load_step", "edge", "i"), held),
        },
        attrs={
            "noise_uncertainty": 0.0,
            "force_uncertainty": 0.0,
            "force_gain_uncertainty": 0.0,
            "force_offset_uncertainty": 0.0,
            "correlation_window": window,
            "thickness": 1.0,
            "outline": "edge",
            "mesh": "finer" if window else "measured_grid",
            "forces": "measured",
        },
    )
    return data, mesh, params


def believed(data, noise):
    """A measurement whose displacements are believed to be as noisy as this."""
    level = data["noise_level"] * 0.0 + noise
    return data.assign(noise_level=level, noise_scatter=level)


def square(X):
    return (np.abs(X - 0.5) < 0.25).all(axis=1)


def observed_coarsely(cells, inclusion, load, window, terms=(), **values):
    """(measurement of every second node through a window, the share of the inclusion in every measured cell)."""
    data, mesh, _ = sheet(2 * cells, inclusion, load, window=window, terms=terms, **values)
    lines = np.linspace(0.0, 1.0, cells + 1)
    grid = rectilinear(lines, lines)
    u = data["u_measured"].values[0]
    seen = (window_average(mesh, window) @ u.reshape(len(u), -1).T).T.reshape(u.shape)
    every_second = (2 * np.arange(cells + 1)[:, None] * (2 * cells + 1) + 2 * np.arange(cells + 1)).ravel()
    data = data.drop_dims(["node", "cell"]).assign(
        X=(("node", "i"), grid.nodes),
        cells=(("cell", "vertex"), grid.cells),
        relative_thickness=("cell", np.ones(len(grid.cells))),
        u_measured=(("repeat", "load_step", "node", "i"), seen[None, :, every_second]),
    )
    inside = inclusion(mesh.centres).reshape(cells, 2, cells, 2).mean(axis=(1, 3)).ravel()
    return data, inside
