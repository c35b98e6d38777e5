"""Measured forces on the edges of a sheet, and their shared errors."""

import itertools
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hypernode.data.measurement import (
    force_gain_uncertainty,
    force_offset_uncertainty,
    is_cut_out,
    stress_resultants,
)
from hypernode.data.seen_share import believed_shares
from hypernode.fem.mesh import EDGE_NAMES, EDGES, Mesh
from hypernode.identification import priors


@dataclass(frozen=True, kw_only=True)
class EdgeForce:
    """A measured resultant.

    Attributes:
        step: load step.
        direction: weights of the nodal forces in the resultant.
        value, sigma: force, and its uncertainty that no other force shares.
        channel: load case, component and normal of what a load cell measured along one axis in one test.
        gain, offset: uncertainty of ``value`` by the gain and by the zero of that load cell, which all of its forces
            share.
    """

    step: int
    direction: np.ndarray
    value: float
    sigma: float
    channel: tuple[int, int, int]
    gain: float
    offset: float


def shared_errors(forces: list[EdgeForce]) -> Float[np.ndarray, "force error"]:
    """Errors of forces by independent standard normal numbers: the gain and the zero of every channel."""
    channels = sorted({force.channel for force in forces})
    errors = np.zeros((len(forces), 2 * len(channels)))
    for row, force in zip(errors, forces, strict=True):
        column = 2 * channels.index(force.channel)
        row[column : column + 2] = force.gain, force.offset
    return errors[:, errors.any(axis=0)]


def edge_forces(measurement, mesh: Mesh, relative: Float[np.ndarray, " step"]) -> list[EdgeForce]:
    """Measured resultants, one a step and component.

    A load cell tells one force, so that both edges are one datum. Their balance gives the other edge. A grid that is
    cut out of a larger sheet is treated otherwise, since its sides carry forces that are not known. There the mean of
    both edges counts, and what they carry of the force of the whole sheet (:mod:`hypernode.data.seen_share`).

    Args:
        mesh: on whose nodes they act.
        relative: uncertainty of the forces of each step over their size.
    """
    force, carried = stress_resultants(measurement), believed_shares(measurement)
    gains, offsets = force_gain_uncertainty(measurement), force_offset_uncertainty(measurement)
    load_case, cut = measurement["load_case"].values, is_cut_out(measurement)
    constrained = measurement["edge_constrained"].values > 0
    largest = np.nan_to_num(np.abs(force)).max(axis=(1, 2))
    forces = []
    for step in range(len(force)):
        case = load_case[step]
        for edges, i in itertools.product((("right", "left"), ("top", "bottom")), range(2)):
            known = [
                e for e in map(EDGE_NAMES.index, edges) if constrained[step, e, i] and np.isfinite(force[step, e, i])
            ]
            if not known:
                continue
            known = known if cut else known[:1]
            axis, outward = EDGES[EDGE_NAMES[known[0]]]
            direction, value = np.zeros(mesh.nodes.shape), 0.0
            for e in known:
                edge = EDGE_NAMES[e]
                sign = outward * EDGES[edge][1] / len(known)
                direction[mesh.on_edge(edge), i] = sign
                value += sign * carried[step, axis] * float(force[step, e, i])
            sigma = relative[step] * max(abs(value), priors.SMALLEST_FORCE * largest[step])
            of_channel = force[load_case == case][:, [2 * axis, 2 * axis + 1], i]
            offset = outward * offsets * float(np.nanmax(np.abs(of_channel)))
            forces.append(
                EdgeForce(
                    step=step,
                    direction=direction.ravel(),
                    value=value,
                    sigma=sigma,
                    channel=(int(case), i, axis),
                    gain=gains * value,
                    offset=offset,
                )
            )
    return forces
