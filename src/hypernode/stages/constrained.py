"""Equilibrium as a constraint: the material field whose finite-element solution is what was measured.

Displacements are data here, not input. The unknown is a field of convex-basis coefficients, one set a
cell; for every guess JAX-FEM solves the equilibrium of each load step, and the misfit of displacements
and edge forces, in units of their noise, is reduced together with the jumps of the field by
Gauss-Newton steps. Nothing measured is ever differentiated, so noise hardly matters.

The stiffness alone comes first: one number a cell finds where the material changes, along a path without the
valleys that all coefficients together make. From there the other terms are released. Where noise makes
many minima, what was found is shaken out of its own to see whether there is a better one. Where interfaces lie
anywhere and noise does not hide them, cells are then divided.
"""

import numpy as np

from hypernode.config.methods import Constrained
from hypernode.identification.strategy import identify
from hypernode.material.basis_file import basis_content
from hypernode.storage.netcdf import read, units_of, write


def run(settings: Constrained, name: str, measurement_file: str, output: str, attributes: dict) -> None:
    """Identify the field of basis coefficients and write its equilibrium states.

    Args:
        settings: the method's ``constrained`` section.

    Raises:
        IdentificationError: no equilibrium at the homogeneous start.
    """
    measurement = read(measurement_file)
    found = identify(measurement, settings, name)
    problem, params, states, history = found.problem, found.params, found.states, found.history
    refinement = problem.refinement
    u = np.stack([state.u[refinement.nodes] for state in states])
    variables = {key: measurement[key].values for key in ("X", "cells", "corners", "load_case", "stretch")}
    variables |= {"u": u, "loss": history, "loss_iteration": np.arange(len(history))}
    content, kind = basis_content(problem.basis, params.T[:, refinement.subcells.T])
    variables |= content
    # Without noise there is nothing that a test cannot tell apart by chance.
    if settings.posterior_samples and problem.noisy:
        draws = found.objective.draws(params, settings.posterior_samples, settings.seed)
        draws = np.moveaxis(draws, -1, 0)[..., refinement.subcells.T]
        dims = ("posterior_sample", "part", "cell")
        variables |= {f"posterior.{key}": (dims, draws[k]) for k, key in enumerate(problem.basis.names)}
    if "F_truth" in measurement:
        variables["F_truth"] = measurement["F_truth"].values
    write(
        output,
        variables,
        f"equilibrium field of {name}",
        {
            **attributes,
            "units": units_of(measurement),
            **kind,
            "displacement_sigma": problem.sigma,
            "displacement_misfit": float(history[-1]),
            "force_misfit": found.force_misfit,
            "homogeneous_force_misfit": problem.force_misfit.tolist(),
        },
        parents=[measurement_file],
    )
