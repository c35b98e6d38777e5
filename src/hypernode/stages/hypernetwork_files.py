"""How the stages that train a hyper-network read what they need and write what they leave."""

import json
from collections.abc import Mapping

import numpy as np

from hypernode.config.methods import Method
from hypernode.data.measurement import field_gradient
from hypernode.material.domain import Domain
from hypernode.material.domain_file import domain_content
from hypernode.networks.weights import to_arrays
from hypernode.storage.netcdf import read, units_of, write
from hypernode.storage.schema import without_truth
from hypernode.training.loop import Fit
from hypernode.training.problem import InverseProblem


def open_problem(method: Method, name: str, files: Mapping[str, str]) -> InverseProblem:
    """The problem of the files of the earlier stages; see :class:`InverseProblem` for their names."""
    return InverseProblem(name, method, {key: without_truth(read(path)) for key, path in files.items()})


def save(
    problem: InverseProblem,
    fit: Fit,
    title: str,
    files: Mapping[str, str],
    output: str,
    attributes: dict,
    variables: Mapping | None = None,
    measures: Mapping | None = None,
) -> None:
    """Write a trained network with everything :func:`hypernode.load_material` needs.

    Args:
        variables, measures: further variables and attributes that the stage has of its own.
    """
    mesh, F = problem.mesh, np.moveaxis(field_gradient(problem.inputs["field"]), (0, 1), (2, 3))
    seen, domain = domain_content(Domain.of(F, problem.node.has_fibres))
    write(
        output,
        {
            **to_arrays(fit.params, "hypernetwork"),
            "X": mesh.nodes,
            "cells": mesh.cells,
            "corners": np.stack([mesh.lower, mesh.upper]),
            "loss": fit.losses,
            "loss_iteration": fit.iterations,
            **seen,
            **(variables or {}),
        },
        f"{title} of {problem.name}",
        {
            **attributes,
            **domain,
            **(measures or {}),
            "units": units_of(problem.inputs["measurement"]),
            "material_kind": "node",
            "node": json.dumps(problem.spec),
            "hypernetwork": problem.hypernetwork,
            "length_scale": problem.length,
        },
        parents=list(files.values()),
    )
