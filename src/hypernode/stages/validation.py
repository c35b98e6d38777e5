"""Stage 10: the identified field in a finite-element computation of loads that were not in the test."""

import sys

import jax.numpy as jnp
import numpy as np

from hypernode.config import Config
from hypernode.material import node_stress, parameter_field
from hypernode.mechanics.equilibrium import EDGE_NAMES
from hypernode.mechanics.loads import make_load
from hypernode.progress import Progress
from hypernode.stages.equilibrium_solver import ConvergenceError, EquilibriumSolver
from hypernode.stages.fields import mesh_of
from hypernode.stages.forward import resultants, true_sheet
from hypernode.storage.netcdf import read, units_of, write


def _solve(solver, loads, progress):
    """(u[step, node, i], edge forces[step, edge, i]) of every load, NaN for a load without equilibrium."""
    u, forces = [], []
    for load in loads:
        try:
            fields, _ = solver.solve(load, lambda step, history: progress.advance(residual=history[-1]))
        except ConvergenceError as error:
            print(f"no equilibrium: {error}", file=sys.stderr)
            u += [np.full(solver.mesh.nodes.shape, np.nan)] * len(load.H)
            forces += [np.full((len(EDGE_NAMES), 2), np.nan)] * len(load.H)
            continue
        for field in fields:
            u.append(field)
            forces.append(resultants(solver, field, load))
    return np.stack(u), np.stack(forces)


def run(config: Config, name: str, truth_file: str, material_file: str, output: str, attributes: dict) -> None:
    """Solve the unseen loads with the true and the identified material and compare what would be measured.

    The identified field is sampled at the cell centres of the true sheet's mesh. Errors are relative L2
    norms over all steps of a load, of the displacements and of the resultants; the worst load counts. Loads
    for which one of the two materials has no equilibrium are counted, and make the errors NaN.
    """
    truth, file = read(truth_file), read(material_file)
    mesh, case = mesh_of(truth), config.cases[name]
    loads = [make_load(config.loads[key].kind, config.loads[key].stretches) for key in case.unseen_loads]
    node, params_at = parameter_field(file)
    identified = np.asarray(params_at(mesh.centres).T, float)
    solvers = (
        true_sheet(truth)[0],
        EquilibriumSolver(
            mesh,
            lambda F, p: node_stress(node, F[..., None], p["node"][:, None])[..., 0],
            {"node": jnp.asarray(identified)},
        ),
    )
    progress = Progress("validation", name, 2 * sum(len(load.H) for load in loads))
    (u_true, f_true), (u, f) = (_solve(solver, loads, progress) for solver in solvers)
    test = np.concatenate([np.full(len(load.H), k) for k, load in enumerate(loads)])

    def worst(found, true):
        errors = [
            np.linalg.norm(found[test == k] - true[test == k]) / np.linalg.norm(true[test == k])
            for k in range(len(loads))
        ]
        return float(np.max(errors))

    write(
        output,
        {
            "X": mesh.nodes,
            "cells": mesh.cells,
            "corners": np.stack([mesh.lower, mesh.upper]),
            "test": test,
            "stretch": np.concatenate([load.stretch for load in loads]),
            "u": u,
            "u_truth": u_true,
            "edge_force": f_true,
            "edge_force_identified": f,
        },
        f"unseen loads of {name}",
        {
            **attributes,
            "units": units_of(truth),
            "tests": case.unseen_loads,
            "summary": {
                "unseen_displacement_error": worst(u, u_true),
                "unseen_force_error": worst(f, f_true),
                "unseen_without_equilibrium": len({int(k) for k in test[np.isnan(u + u_true).any(axis=(1, 2))]}),
            },
        },
        parents=[truth_file, material_file],
    )
