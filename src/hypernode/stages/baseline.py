"""What every mechanics laboratory knows: identifications without networks, on the same data.

Moduli of a neo-Hookean sheet by the methods of :mod:`hypernode.baselines`; or the constrained field as it is.
"""

import numpy as np
import xarray as xr

from hypernode.baselines.constitutive_gap import constitutive_gap_moduli
from hypernode.baselines.equilibrium_gap import NEO_HOOKEAN, equilibrium_gap_moduli, homogeneous_modulus
from hypernode.baselines.reciprocity_gap import reciprocity_gap_moduli
from hypernode.baselines.regions import two_regions
from hypernode.baselines.updating import Sheet, updated_moduli
from hypernode.baselines.updating_cells import updated_field
from hypernode.baselines.virtual_fields import virtual_fields_moduli
from hypernode.config.methods import Method
from hypernode.data.loading import Loading
from hypernode.data.lost import filled
from hypernode.data.measurement import displacement_noise, field_gradient, measured_displacement, mesh_of, nodal_forces
from hypernode.material.basis_file import basis_content, basis_field
from hypernode.material.domain import Domain
from hypernode.material.domain_file import domain_content
from hypernode.material.files import LINES
from hypernode.storage.netcdf import read, units_of, write
from hypernode.storage.schema import without_truth


def moduli_of(method: Method, measurement: xr.Dataset, F) -> tuple[np.ndarray, dict]:
    """(coefficient of every cell, what else was found) by the method's baseline, from opened data without truth."""
    mesh, loading, name = mesh_of(measurement), Loading.of(measurement), method.baseline
    if name == "homogeneous":
        return np.full(len(mesh.cells), homogeneous_modulus(mesh, loading, F)), {}
    if name == "equilibrium_gap":
        moduli, weight = equilibrium_gap_moduli(mesh, loading, F, method.seed)
        return moduli, {"smoothness_weight": weight}
    if name == "constitutive_gap":
        moduli, alternations = constitutive_gap_moduli(mesh, loading, F)
        return moduli, {"alternations": alternations}
    u = filled(mesh, measured_displacement(measurement))
    if name == "reciprocity_gap":
        return reciprocity_gap_moduli(mesh, loading, F, u, nodal_forces(measurement)), {}
    return _of_regions(method, mesh, loading, F, u, displacement_noise(measurement))


def _of_regions(method: Method, mesh, loading: Loading, F, u, noise: float) -> tuple[np.ndarray, dict]:
    """:func:`moduli_of` by virtual fields or model updating, of the regions that the method asks for.

    Two regions are told apart by the moduli of the constitutive equation gap, which noise disturbs less than others.
    """
    found, cells = {}, len(mesh.cells)
    if method.regions == "cells" and method.baseline == "updating":
        moduli, iterations = updated_field(Sheet(mesh, loading, u, noise), homogeneous_modulus(mesh, loading, F))
        return moduli, {"iterations": iterations}
    if method.regions == "two":
        moduli, found["alternations"] = constitutive_gap_moduli(mesh, loading, F)
        region = two_regions(moduli)
    else:
        region = np.arange(cells) if method.regions == "cells" else np.zeros(cells, int)
    if method.baseline == "virtual_fields":
        return virtual_fields_moduli(mesh, loading, F, region), found
    return updated_moduli(Sheet(mesh, loading, u, noise), region, homogeneous_modulus(mesh, loading, F)), found


def run(method: Method, name: str, files: dict[str, str], output: str, attributes: dict) -> None:
    """Identify a material without networks and write it.

    Args:
        method: holds ``baseline``, ``regions`` and ``seed``.
        files: ``measurement`` and ``field`` (the deformation gradient), and ``constrained`` for that baseline.
    """
    measurement = without_truth(read(files["measurement"]))
    mesh = mesh_of(measurement)
    found, geometry, F = {}, {}, field_gradient(read(files["field"]))
    if method.baseline == "constrained":
        constrained = read(files["constrained"])
        basis, params = basis_field(constrained)
        geometry = {key: constrained[key].values for key in LINES if key in constrained}
    else:
        moduli, found = moduli_of(method, measurement, F)
        basis, params = NEO_HOOKEAN, np.log(moduli)[None, None]
    content, kind = basis_content(basis, params)
    seen, measures = domain_content(Domain.of(np.moveaxis(F, (0, 1), (2, 3)), basis.has_fibres))
    write(
        output,
        {
            "X": mesh.nodes,
            "cells": mesh.cells,
            "corners": np.stack([mesh.lower, mesh.upper]),
            **content,
            **geometry,
            **seen,
        },
        f"baseline material of {name}",
        {
            **attributes,
            **found,
            "units": units_of(measurement),
            **kind,
            **measures,
        },
        parents=list(files.values()),
    )
