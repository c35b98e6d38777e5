"""Stage 10: the identified field in a finite-element computation of loads that were not in the test."""

import numpy as np

from hypernode.config.model import Config
from hypernode.data.measurement import mesh_of
from hypernode.evaluation.validation import compare, identified_sheet, respond
from hypernode.material.files import parameter_field
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
    progress = Progress("validation", name, 2 * sum(len(load.H) for load in loads))
    true = respond(true_sheet(truth)[0], loads, progress)
    found = respond(identified_sheet(mesh, node, np.asarray(params_at(mesh.centres).T, float)), loads, progress)
    load_case = np.repeat(np.arange(len(loads)), [len(load.H) for load in loads])
    write(
        output,
        {
            "X": mesh.nodes,
            "cells": mesh.cells,
            "corners": np.stack([mesh.lower, mesh.upper]),
            "load_case": load_case,
            "stretch": np.concatenate([load.stretch for load in loads]),
            "u": found.u,
            "u_truth": true.u,
            "edge_force": true.edge_force,
            "edge_force_identified": found.edge_force,
        },
        f"unseen loads of {name}",
        {
            **attributes,
            "units": units_of(truth),
            "load_cases": case.unseen_loads,
            "summary": compare(found, true, load_case),
        },
        parents=[truth_file, material_file],
    )
