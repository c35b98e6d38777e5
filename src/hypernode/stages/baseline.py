"""What every mechanics laboratory knows: identifications without networks, on the same data.

One modulus for the whole sheet; a neo-Hookean modulus in every cell from the equilibrium gap of the measured
deformation (a virtual-fields method with one hat function a node); or the constrained field as it is.
"""

import numpy as np

from hypernode.config.methods import Method
from hypernode.data.loading import Loading
from hypernode.data.measurement import field_gradient, mesh_of
from hypernode.identification.baselines import NEO_HOOKEAN, equilibrium_gap_moduli, homogeneous_modulus
from hypernode.material.basis_file import basis_content, basis_field
from hypernode.material.domain import Domain
from hypernode.material.domain_file import domain_content
from hypernode.storage.netcdf import read, units_of, write


def run(method: Method, name: str, files: dict[str, str], output: str, attributes: dict) -> None:
    """Identify a material without networks and write it.

    Args:
        method: holds ``baseline`` and ``seed``.
        files: ``measurement`` and ``field`` (the deformation gradient), and ``constrained`` for that baseline.
    """
    measurement = read(files["measurement"])
    mesh = mesh_of(measurement)
    found, F = {}, field_gradient(read(files["field"]))
    if method.baseline == "constrained":
        basis, params = basis_field(read(files["constrained"]))
    else:
        loading = Loading.of(measurement)
        if method.baseline == "homogeneous":
            moduli = np.full(len(mesh.cells), homogeneous_modulus(mesh, loading, F))
        else:
            moduli, found["smoothness_weight"] = equilibrium_gap_moduli(mesh, loading, F, method.seed)
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
