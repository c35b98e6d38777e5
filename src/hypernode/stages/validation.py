"""Stage 10: the identified field in a finite-element computation of loads that were not in the test."""

import jax.numpy as jnp
import numpy as np

from hypernode.config.model import Config
from hypernode.data.measurement import mesh_of
from hypernode.evaluation.validation import _solve
from hypernode.fem.solver import EquilibriumSolver
from hypernode.material.files import parameter_field
from hypernode.material.laws import node_stress
from hypernode.mechanics.loads import make_load
from hypernode.progress import Progress
from hypernode.storage.netcdf import read, units_of, write
from hypernode.synthetic.forward import true_sheet


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
    load_case = np.concatenate([np.full(len(load.H), k) for k, load in enumerate(loads)])

    def worst(found, true):
        errors = [
            np.linalg.norm(found[load_case == k] - true[load_case == k]) / np.linalg.norm(true[load_case == k])
            for k in range(len(loads))
        ]
        return float(np.max(errors))

    write(
        output,
        {
            "X": mesh.nodes,
            "cells": mesh.cells,
            "corners": np.stack([mesh.lower, mesh.upper]),
            "load_case": load_case,
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
            "load_cases": case.unseen_loads,
            "summary": {
                "unseen_displacement_error": worst(u, u_true),
                "unseen_force_error": worst(f, f_true),
                "unseen_without_equilibrium": len({int(k) for k in load_case[np.isnan(u + u_true).any(axis=(1, 2))]}),
            },
        },
        parents=[truth_file, material_file],
    )
