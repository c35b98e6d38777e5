"""Stage 11: what was identified, in sheets of one phase each and in frames that were not used, against their tests."""

import json
from collections.abc import Mapping

import jax.numpy as jnp
import numpy as np

from hypernode.material import node_stress, parameter_field
from hypernode.mechanics.equilibrium import EDGE_NAMES
from hypernode.progress import Progress
from hypernode.stages.equilibrium_solver import ConvergenceError, EquilibriumSolver
from hypernode.stages.fields import displacement_noise, mesh_of, relaxation
from hypernode.stages.held_edges import held_displacement
from hypernode.storage.netcdf import read, units_of, write

#: Phases by the value of an evaluation's ``shape``.
PHASES = ("matrix", "inclusion")
#: The identified field itself, in other frames of its own test.
WHOLE = "whole"


def typical_place(evaluation, phase: str):
    """Centre (1, 2) of the cell whose indicator is the median of its phase.

    The identified stiffness varies over a phase by a tenth or more; no single place chosen by its position, such
    as the one farthest from the outline, stands for it.

    Raises:
        ValueError: no cell belongs to the phase.
    """
    cells = np.flatnonzero(evaluation["shape"].values == PHASES.index(phase))
    if not len(cells):
        raise ValueError(f"no cell was found to belong to the {phase}: there is nothing to compare with its sheet")
    order = cells[np.argsort(evaluation["trace_P"].values[cells], kind="stable")]
    return mesh_of(evaluation).centres[order[[len(order) // 2]]]


def pulled_sheet(measurement, node, node_params, progress: Progress):
    """Resultants (step, edge, i) of a sheet whose outline moves as it was measured.

    Args:
        measurement: measurement file of the sheet.
        node, node_params: the material and its weights, at one point or at every cell's centre (cell, weight).

    Raises:
        ConvergenceError: a step has no equilibrium.
    """
    mesh = mesh_of(measurement)
    held = np.ones((len(EDGE_NAMES), 2))
    solver = EquilibriumSolver(
        mesh,
        lambda F, p: node_stress(node, F[..., None], p["node"][:, None])[..., 0],
        {"node": jnp.broadcast_to(node_params, (len(mesh.cells), node_params.shape[-1]))},
    )
    forces, noise = [], displacement_noise(measurement)
    for step, u in enumerate(measurement["u_measured"].values.mean(axis=0)):
        edges = held_displacement(mesh, u, held, noise)
        reached = solver.newton(np.where(edges.mask, edges.values, u), np.flatnonzero(edges.mask.ravel()), 1e-8)
        if reached.u is None:
            raise ConvergenceError(
                f"step {step}: no equilibrium of the sheet with the identified material (relative residual "
                f"{reached.history[-1]:.1e}); its stretch may be beyond what the identified test has seen"
            )
        force = reached.force.reshape(-1, 2)
        forces.append([force[mesh.on_edge(edge)].sum(axis=0) for edge in EDGE_NAMES])
        progress.advance(residual=reached.history[-1])
    return np.array(forces) * float(measurement.attrs["thickness"]) * relaxation(measurement)


def run(name: str, references: Mapping[str, str], files: Mapping[str, str], output: str, attributes: dict) -> None:
    """Pull every reference sheet and compare its forces with those measured.

    The material of a phase is the identified one at its typical place; the whole is the identified field. The error
    is the root mean square over the largest measured force of the sheet.

    Args:
        name: case of the identified specimen.
        references: phase -> case of the sheet that consists of it, ``whole`` -> case of other frames of the test.
        files: ``evaluation``, ``material``, and a measurement file by phase.
    """
    evaluation, material = read(files["evaluation"]), read(files["material"])
    node, params_at = parameter_field(material)
    measured, found, stretch, test = [], [], [], []
    phases = [phase for phase in (*PHASES, WHOLE) if phase in references]
    sheets = [read(files[phase]) for phase in phases]
    progress = Progress("references", name, sum(sheet.sizes["load_step"] for sheet in sheets))
    errors = {}
    for index, (phase, sheet) in enumerate(zip(phases, sheets, strict=True)):
        places = mesh_of(sheet).centres if phase == WHOLE else typical_place(evaluation, phase)
        forces = pulled_sheet(sheet, node, jnp.asarray(np.asarray(params_at(places).T, float)), progress)
        true = sheet["edge_force"].values
        known = np.isfinite(true)
        errors[phase] = float(np.sqrt(np.mean((forces - true)[known] ** 2)) / np.abs(true[known]).max())
        measured.append(true)
        found.append(forces)
        stretch.append(sheet["stretch"].values)
        test.append(np.full(len(forces), index))
    write(
        output,
        {
            "test": np.concatenate(test),
            "stretch": np.concatenate(stretch),
            "edge_force": np.concatenate(measured),
            "edge_force_identified": np.concatenate(found),
        },
        f"other tests with what was identified in {name}",
        {
            **attributes,
            "units": units_of(material),
            "tests": [f"{phase}: {references[phase]}" for phase in phases],
            "load": json.loads(sheets[0].attrs["tests"])[0],
            "summary": {f"reference_nrmse_{phase}": error for phase, error in errors.items()},
        },
        parents=files.values(),
    )
