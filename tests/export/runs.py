"""A small finished run: a sheet in homogeneous deformations with an inclusion twice as stiff, as files hold it."""

import numpy as np

from hypernode.fem.gradient import deformation_gradient
from hypernode.fem.mesh import rectilinear
from hypernode.material.basis_file import basis_content
from hypernode.material.domain import Domain
from hypernode.material.domain_file import domain_content
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.mechanics.loads import make_load
from hypernode.storage.netcdf import EXPERIMENT_UNITS, write
from hypernode.verdict import Criterion, Level, Verdict
from tests.sheets import square

MESH = rectilinear(np.linspace(0.0, 1.0, 7), np.linspace(0.0, 1.0, 6))
PHASE = square(MESH.centres).astype(int)
#: Shear moduli of the phases.
MU = np.array([0.6, 1.2])
#: Relative standard deviation of the moduli over the posterior samples.
SPREAD = 0.02
LOAD = make_load("biaxial", [(1.1, 1.05), (1.2, 1.1), (1.3, 1.15)])
U = np.einsum("siJ,nJ->sni", LOAD.H, MESH.nodes)
THICKNESS = 0.8
VERDICT = Verdict((Criterion("forces", Level.WARNED, "Edge forces are missed by 4 %.", value=0.04, threshold=0.03),))


def write_run(results, case="skin"):
    """The folder of a run whose files lie in a results folder."""
    folder, basis = results / case / "hypernode", ConvexBasis((), 0.3)
    units, grid = {"units": EXPERIMENT_UNITS}, {
        "X": MESH.nodes, "cells": MESH.cells, "corners": np.stack([MESH.lower, MESH.upper]),
    }  # fmt: skip
    steps = {"load_case": np.zeros(3, int), "stretch": LOAD.stretch}
    measurement, gradient, constrained, material = (
        folder / name for name in ("../measurement.nc", "gradient.nc", "constrained.nc", "material.nc")
    )
    write(
        measurement,
        {**grid, **steps, "u_measured": U[None], "relative_thickness": np.ones(len(PHASE))},
        "measurement",
        {**units, "thickness": THICKNESS, "load_cases": ["pull"]},
    )
    level = np.log(0.5 * MU[PHASE])
    best, kind = basis_content(basis, level[None, None])
    samples = np.random.default_rng(4).normal(0.0, 1.0, (8, 2))
    samples = SPREAD * (samples - samples.mean(axis=0)) / samples.std(axis=0, ddof=1)
    posterior = (("posterior_sample", "subcell", "cell"), (level + samples[:, PHASE])[:, None])
    F = deformation_gradient(MESH, U)
    seen, measures = domain_content(Domain.of(F, directional=False))
    everything = {**units, **kind, **measures}
    field = {**grid, **steps, **best, **seen, "u": U, "posterior.log_level": posterior}
    write(constrained, field, "equilibrium field", everything, [measurement])
    write(gradient, {**grid, **steps, "F": F}, "gradient", units, [constrained])
    write(material, {**grid, **best, **seen}, "identified material", everything, [measurement, constrained, gradient])
    trace = 2.0 * MU[PHASE] * (1.1 - 1.1**-5)
    write(
        folder / "evaluation.nc",
        {
            **grid, "stretch": LOAD.stretch, "trace_P": trace, "trace_P_spread": SPREAD * trace, "shape": PHASE,
            "phase_found": PHASE,
        },
        "evaluation",
        {
            **units, "load": "biaxial", "shape_stretch": 1.1, "verdict": VERDICT.stored(),
            "run": {"case": case, "method": "hypernode"},
        },
        [measurement, gradient, constrained, material],
    )  # fmt: skip
    return folder
