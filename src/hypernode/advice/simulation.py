"""What cameras and load cells would record of a further test, were the identified field the sheet."""

import json

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.advice.candidates import Candidate
from hypernode.data.measurement import noise_of_steps, scatter_of_steps
from hypernode.fem.mesh import EDGE_NAMES, EDGES
from hypernode.identification.problem import FieldProblem
from hypernode.mechanics.loads import RESULTANTS, Load


def recorded(
    problem: FieldProblem,
    params: Float[np.ndarray, "cell parameter"],
    candidate: Candidate,
    measurement: xr.Dataset,
    seed: int,
) -> xr.Dataset:
    """A measurement of the sheet that is ``params`` under another load, with the errors of the present test.

    The same points are seen, through the same window and with the noise of the first load case step by step; none is
    lost. The machine tells what it can of such a load.

    Args:
        problem: of the present test, on whose mesh the equilibrium is computed.
        measurement: opened file of the present test.
        seed: of the noise.

    Raises:
        ConvergenceError: the sheet finds no equilibrium.
    """
    load = candidate.load
    u, force = problem.equilibrium.under(params, load)
    first = np.flatnonzero(measurement["load_case"].values == 0)
    steps = first[np.minimum(np.arange(len(u)), len(first) - 1)]
    level, scatter = (each(measurement)[steps] for each in (noise_of_steps, scatter_of_steps))
    seen = u[:, problem.refinement.nodes]
    seen = seen + level[:, None] * np.random.default_rng(seed).normal(size=seen.shape)
    held = np.zeros((len(EDGE_NAMES), 2))
    for edge, component in load.constrained:
        held[EDGE_NAMES.index(edge), component] = 1.0
    by_step = {
        "u_measured": (("repeat", "load_step", "node", "i"), seen[None]),
        "noise_level": (("load_step", "i"), level),
        "noise_scatter": (("load_step", "i"), scatter),
        "load_case": (("load_step",), np.zeros(len(u), int)),
        "stretch": (("load_step",), load.stretch),
        "H": (("load_step", "i", "J"), load.H),
        "relaxation": (("load_step",), np.ones(len(u))),
        "edge_force": (("load_step", "edge", "i"), _told(load, force) * float(measurement.attrs["thickness"])),
        "edge_constrained": (("load_step", "edge", "i"), np.tile(held, (len(u), 1, 1))),
    }
    sheet = measurement[["X", "cells", "corners", "relative_thickness"]]
    return sheet.assign(by_step).assign_attrs(measurement.attrs | {"load_cases": json.dumps([candidate.name])})


def _told(load: Load, force: Float[np.ndarray, "step edge 2"]) -> Float[np.ndarray, "step edge 2"]:
    """Of the forces on the edges those that a testing machine measures, NaN for the others."""
    known = np.full(force.shape, np.nan)
    for i, J in RESULTANTS[load.kind]:
        edges = [EDGE_NAMES.index(edge) for edge, (axis, _) in EDGES.items() if axis == J]
        known[:, edges, i] = force[:, edges, i]
    return known
