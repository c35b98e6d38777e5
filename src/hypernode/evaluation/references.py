"""The identified material in homogeneous reference sheets and in unused frames, compared with their tests."""

import sys

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from hypernode.data.boundary import prescribed_displacement
from hypernode.data.lost import filled
from hypernode.data.measurement import (
    measured_displacement,
    mesh_of,
    noise_of_steps,
    relative_thickness,
    relaxation,
    relaxation_at,
)
from hypernode.fem.mesh import EDGE_NAMES
from hypernode.fem.solver import ConvergenceError, EquilibriumSolver
from hypernode.material.laws import node_stress
from hypernode.progress import Progress

#: Phases by the value of an evaluation's ``shape``.
PHASES = ("matrix", "inclusion")

#: The identified field itself, in other frames of its own test.
WHOLE = "whole"

#: Quantiles of the stiffness of a phase whose cells together stand for it.
MIDDLE = np.linspace(0.25, 0.75, 5)


def is_found(evaluation, phase: str) -> bool:
    """Whether any cell belongs to a phase."""
    return bool((evaluation["shape"].values == PHASES.index(phase)).any())


def typical_places(evaluation, phase: str) -> Float[np.ndarray, "place 2"]:
    """Centres of cells in the middle half of a phase, ranked by the indicator of their stiffness.

    The identified stiffness varies within a phase by a tenth or more, and cells with equal indicators differ by some
    per cent under other deformations. Several cells therefore represent a phase. At least one cell must belong to it.
    """
    cells = np.flatnonzero(evaluation["shape"].values == PHASES.index(phase))
    order = cells[np.argsort(evaluation["trace_P"].values[cells], kind="stable")]
    return mesh_of(evaluation).centres[order[np.rint(MIDDLE * (len(order) - 1)).astype(int)]]


def pulled_sheet(measurement, node, node_params, progress: Progress):
    """Resultants (step, edge, i) of an elastic sheet whose outline is displaced as measured.

    Args:
        measurement: measurement file of the sheet.
        node, node_params: the material and its weights; the sheet responds as the mean of several places (place,
            weight), or every cell as the mean of its own (cell, place, weight).

    Raises:
        ConvergenceError: a step has no equilibrium.
    """
    mesh = mesh_of(measurement)
    prescribed = np.ones((len(EDGE_NAMES), 2))
    solver = EquilibriumSolver(
        mesh,
        lambda F, p: (
            p["thickness"] * jnp.mean(node_stress(node, jnp.tile(F[..., None], len(p["node"])), p["node"].T), axis=-1)
        ),
        {
            "node": jnp.broadcast_to(node_params, (len(mesh.cells), *node_params.shape[-2:])),
            "thickness": jnp.asarray(relative_thickness(measurement)),
        },
    )
    forces, noise = [], noise_of_steps(measurement)
    measured = measured_displacement(measurement)
    for step, (u, guess) in enumerate(zip(measured, filled(mesh, measured), strict=True)):
        edges = prescribed_displacement(mesh, u, prescribed, noise[step])
        reached = solver.newton(np.where(edges.mask, edges.values, guess), np.flatnonzero(edges.mask.ravel()), 1e-8)
        if reached.u is None:
            raise ConvergenceError(
                f"step {step}: no equilibrium of the sheet with the identified material (relative residual "
                f"{reached.history[-1]:.1e}); its stretch may be beyond what the identified test has seen"
            )
        force = reached.force.reshape(-1, 2)
        forces.append([force[mesh.on_edge(edge)].sum(axis=0) for edge in EDGE_NAMES])
        progress.advance(residual=reached.history[-1])
    return np.array(forces) * float(measurement.attrs["thickness"])


def reference_forces(phase: str, sheet, identified, evaluation, node, params_at, progress: Progress):
    """Resultants (step, edge, i) of a reference sheet with what was identified.

    The material of a phase is the mean of the identified ones at its typical places; that of :data:`WHOLE` is the
    identified field. The relaxed part of the force comes from the record of the reference sheet. For other frames of
    the identified test it comes from the frames that were used, and not from the compared ones.

    Args:
        sheet: measurement file of the reference sheet.
        identified: measurement file of the identified specimen.
        evaluation: evaluation file of the identified specimen.
        node, params_at: the material and its weights as a function of position, parameters first.

    Raises:
        ConvergenceError: as :func:`pulled_sheet`.

    Returns:
        NaN for a phase that was not found, with a message on standard error.
    """
    if phase != WHOLE and not is_found(evaluation, phase):
        print(f"no forces of the {phase}: none was found in the sheet that was identified", file=sys.stderr)
        return np.full(sheet["edge_force"].shape, np.nan)
    places = mesh_of(sheet).centres if phase == WHOLE else typical_places(evaluation, phase)
    node_params = np.asarray(params_at(places).T, float)
    if phase == WHOLE:
        return pulled_sheet(sheet, node, node_params[:, None], progress) * relaxation_at(
            identified, sheet["time"].values
        )
    return pulled_sheet(sheet, node, node_params, progress) * relaxation(sheet)


def force_nrmse(found: Float[np.ndarray, "step edge 2"], measured: Float[np.ndarray, "step edge 2"]) -> float:
    """Root mean square error of the measured resultants, over the largest of them."""
    known = np.isfinite(measured)
    return float(np.sqrt(np.mean((found - measured)[known] ** 2)) / np.abs(measured[known]).max())
