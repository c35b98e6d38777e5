"""A small test whose material a hyper-network holds, exactly or nearly."""

import functools

import numpy as np
import pytest

from hypernode.config.methods import Constrained, Frequencies
from hypernode.fem.mesh import EDGE_NAMES
from hypernode.identification import numerics
from hypernode.identification.problem import problem_of_basis
from hypernode.material.node_law import NodeLaw
from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.loads import make_load
from hypernode.networks.weights import make_network
from hypernode.polishing.weight_field import WeightField
from tests.sheets import believed, sheet, square

NODE = NodeMaterial(terms=("I1", "I2"), hidden=(3,), steps=2, invariant_scale=0.4, stress_scale=2.0, share=0.3)
LAW = NodeLaw(NODE)
FORCE_NOISE = 1e-3


def weight_field(mesh, seed=3):
    """That of a small network whose material differs smoothly over the sheet."""
    network = make_network(Frequencies(features=4, frequency_scale=0.5, widths=[6]), 0, NODE.size, seed)
    last = network.layers[-1]
    last.kernel[...] = np.float32(0.2) * last.kernel[...]
    bias = np.full(NODE.size, 0.3, np.float32)
    bias[-2:] = np.log(0.4), np.log(0.1)
    last.bias[...] = bias
    return WeightField(network, mesh.centres)


def other_weights(field, size):
    """Weights of another material."""
    return field.start + np.random.default_rng(4).normal(0.0, size, field.start.size)


@functools.cache
def problem_of_field(cells, kind, stretches, noise, moved=0.0, tolerance=None):
    """(problem, field) of a test of the sheet that is what the network says, or would say with other weights.

    Args:
        moved: standard deviation of the other weights from the network's own.
        tolerance: relative residual at which a state counts as equilibrium, other than usual.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(numerics, "NEWTON_TOLERANCE", tolerance or numerics.NEWTON_TOLERANCE)
        return _problem_of_field(cells, kind, stretches, noise, moved)


def _problem_of_field(cells, kind, stretches, noise, moved):
    data, mesh, _ = sheet(cells, square, make_load(kind, list(stretches)))
    data, field, settings = believed(data, noise), weight_field(mesh), Constrained(force_noise=FORCE_NOISE)
    problem = problem_of_basis(data, settings, LAW)
    params = field.params(other_weights(field, moved))
    states = problem.equilibrium.states(params, list(problem.observations.u))
    random = np.random.default_rng(1)
    u = np.stack([state.u for state in states])
    measured = u + random.normal(0.0, noise, u.shape)
    on_edges = [[state.force.reshape(-1, 2)[mesh.on_edge(edge)].sum(axis=0) for edge in EDGE_NAMES] for state in states]
    read = np.array(on_edges) * (1.0 + FORCE_NOISE * random.normal(size=(len(u), 1, 2)))
    force = np.where(np.isfinite(data["edge_force"].values), read, np.nan)
    data = data.assign(
        u_measured=(data["u_measured"].dims, measured[None]), edge_force=(data["edge_force"].dims, force)
    )
    return problem_of_basis(data, settings, LAW), field
