"""Stage 2b: the equilibrium field that explains the measured displacements and forces."""

import json

import numpy as np
import xarray as xr

from hypernode.config.methods import Constrained
from hypernode.data.measurement import mesh_of, plane_of
from hypernode.fem.gradient import deformation_gradient
from hypernode.identification.estimate import Estimate
from hypernode.identification.interface_estimate import InterfaceEstimate
from hypernode.identification.left_out import predict_left_out
from hypernode.identification.local_misfit import local_misfit
from hypernode.identification.open_laws import open_laws
from hypernode.identification.strategy import identify
from hypernode.identification.volume import with_area
from hypernode.material.basis_file import basis_content
from hypernode.material.domain import Domain
from hypernode.material.domain_file import domain_content
from hypernode.material.open_files import open_content
from hypernode.storage.netcdf import read, units_of, write
from hypernode.storage.schema import without_truth
from hypernode.trace import stored

#: Samples of every law that explains a test as well: two of each of four directions of fibres.
OPEN_SAMPLES = 8


def run(settings: Constrained, name: str, measurement_file: str, output: str, attributes: dict) -> None:
    """Identify the field of basis coefficients and write its equilibrium states.

    Args:
        settings: the method's ``constrained`` section.

    Raises:
        IdentificationError: no equilibrium at the homogeneous start.
    """
    measurement = read(measurement_file)
    found = identify(without_truth(measurement), settings, name)
    write_field(found, measurement, settings, name, output, attributes, [measurement_file])


def write_field(
    found: Estimate,
    measurement: xr.Dataset,
    settings: Constrained,
    name: str,
    output: str,
    attributes: dict,
    parents: list,
) -> None:
    """Write an identified field, its posterior samples and its record.

    Args:
        measurement: opened, of which the field was identified.
        settings: of the stage.
        name: of the case.
        attributes: added to those of the field.
        parents: files that it follows from.
    """
    problem, history, refinement = found.problem, found.history, found.problem.refinement
    variables = {key: measurement[key].values for key in ("X", "cells", "corners", "load_case", "stretch")}
    variables["u"] = np.stack([state.u[refinement.nodes] for state in found.states])
    variables |= {"loss": history, "loss_iteration": np.arange(len(history))}
    content, kind = basis_content(found.basis, found.by_parts)
    F = deformation_gradient(mesh_of(measurement), variables["u"])
    seen, measures = domain_content(Domain.of(F, found.basis.has_fibres))
    variables |= content | seen
    beside = {}
    if settings.posterior_samples and not problem.certain:
        variables |= _posterior(found, settings)
        beside = _open_laws(found, settings, variables)
    if found.layered:
        variables |= {"P_jump": found.jump_stress(F)}
    variables |= _geometry(found)
    local, left_out = local_misfit(found), predict_left_out(found)
    if local is not None:
        variables |= {"local_misfit": local.values, "unexplained": local.unexplained.astype(np.int8)}
        variables |= {"residual": local.residuals}
        beside |= {"independent_residuals": local.independent}
    if "F_truth" in measurement:
        variables["F_truth"] = measurement["F_truth"].values
    write(
        output,
        variables,
        f"equilibrium field of {name}",
        {
            **attributes,
            **kind,
            **measures,
            **_ending(found),
            **beside,
            **({} if left_out is None else {"left_out": json.dumps(left_out.stored())}),
            "units": units_of(measurement),
            "plane": plane_of(measurement),
            **_kind_of_field(found),
            **_of_test(found),
        },
        parents=parents,
    )


def _of_test(found: Estimate) -> dict:
    """Attributes of what was tried, and of the noise and the window that are believed."""
    problem = found.problem
    window = problem.observations.believed_window
    return {
        "trace": stored(found.trace.rows(found.trial)),
        "displacement_sigma": problem.sigma,
        **problem.observations.believed_noise.stored(),
        **({} if window is None else window.stored()),
        "observed_displacements": problem.observed,
        "noise_rules_displacements": problem.noisy,
        "noise_deformation": problem.observations.noise_deformation,
        "homogeneous_force_misfit": problem.homogeneous.force_misfit.tolist(),
    }


def _kind_of_field(found) -> dict:
    """Attributes that say what the field is made of."""
    kind = {"materials": found.material_count, "gradual": found.gradual, "layered": found.layered}
    return kind | ({"line_error": found.line_error} if found.layered else {})


def _geometry(found) -> dict:
    """Which material every cell is of, and where the lines between materials run; none of cells of their own."""
    if found.material_count == 0:
        return {}
    geometry = {"material_label": found.labels.astype(np.int16)}
    return geometry | {"interface_distance": found.distances} if found.layered else geometry


def _posterior(found, settings: Constrained) -> dict:
    """Variables of the posterior samples, by parameter of the basis."""
    samples = found.samples(settings.posterior_samples, settings.seed)
    dims = ("posterior_sample", "subcell", "cell")
    return {f"posterior.{key}": (dims, samples[k]) for k, key in enumerate(found.basis.names)}


def _open_laws(found, settings: Constrained, variables: dict) -> dict:
    """Attributes of the laws that explain the test as well; adds their samples to the variables."""
    if not isinstance(found, InterfaceEstimate):
        return {}
    samples, attributes = open_content(open_laws(found, settings, OPEN_SAMPLES, settings.seed))
    variables |= samples
    return attributes | {"volume_compared": with_area(settings) is not None}


def _ending(found) -> dict:
    """How the descent to the field ended, as attributes."""
    ending = {"ending": str(found.ending), "misfits": json.dumps(found.misfits)}
    if found.step is not None:
        ending |= {"gradient_norm": found.step.gradient_norm, "cg_residual": found.step.cg_residual}
    return ending
