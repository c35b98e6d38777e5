"""Stage 9: how good an identified material is, on one scale for every run."""

from collections.abc import Mapping

import numpy as np

from hypernode.config.model import Config
from hypernode.data.loading import Loading
from hypernode.data.measurement import field_gradient, mesh_of
from hypernode.evaluation.judge import (
    CURVE_POINTS,
    SHAPE_STRETCH,
    _judge_constrained,
    _judge_curves,
    _judge_equilibrium,
    _judge_noise,
    _judge_printed,
    _judge_shape,
    _judge_spread,
    _judge_truth,
    trained_weights,
)
from hypernode.evaluation.probes import indicator, stress_at_common_F
from hypernode.evaluation.shape import (
    find_inclusion,
    most_interior,
)
from hypernode.material.files import material_of
from hypernode.mechanics.kinematics import largest_principal_strain
from hypernode.mechanics.modes import MODES, mode_gradients
from hypernode.storage.netcdf import read, sha256, units_of, write


def run(config: Config, name: str, files: Mapping[str, str], output: str, attributes: dict) -> None:
    """Judge one run and write every number and field that figures and tables show.

    Args:
        files: paths of ``measurement``, ``gradient``, ``field`` (interpolant or gradient), ``material``,
            ``constrained`` where the method has one, ``truth`` where it is known, and ``printed``, the image of a
            specimen's shape.
    """
    files = dict(files)
    printed = files.pop("printed", None)
    case = config.cases[name]
    # The field is the gradient itself where the method has no interpolant: read each file once.
    opened = {path: read(path) for path in dict.fromkeys(files.values())}
    measurement, gradient, deformation, material = (
        opened[files[key]] for key in ("measurement", "gradient", "field", "material")
    )
    truth = opened[files["truth"]] if "truth" in files else None
    mesh, loading = mesh_of(measurement), Loading.of(measurement)
    X = mesh.centres
    found = material_of(material)
    kind = config.loads[case.loads[0]].kind if case.loads else config.specimens[case.specimen].load
    largest = float(measurement["stretch"].values.max())
    stretches = np.array(case.judged_stretches or measurement["stretch"].values[loading.load_case == 0])
    F = mode_gradients(stretches)
    F_seen = np.moveaxis(field_gradient(deformation), (0, 1), (2, 3))
    P_field = np.asarray(found.stress(X, F_seen), float)
    shape_stretch = min(SHAPE_STRETCH, largest)
    field = indicator(found, X, kind, shape_stretch)
    shape = find_inclusion(mesh, field)
    variables = {
        "X": mesh.nodes,
        "cells": mesh.cells,
        "corners": np.stack([mesh.lower, mesh.upper]),
        "stretch": measurement["stretch"].values,
        "mode_F": F,
        "P_identified": stress_at_common_F(found, X, F),
        "trace_P": field,
        "shape": shape.astype(np.int64),
        "P_field": P_field,
        "principal_strain": np.asarray(largest_principal_strain(np.moveaxis(gradient["F"].values, (2, 3), (0, 1)))),
    }
    summary = {"case": name}
    if weights := trained_weights(material):
        summary["parameters"] = weights
    _judge_equilibrium(mesh, loading, measurement, P_field, variables, summary)
    if "misfit" in deformation:
        variables["misfit"] = deformation["misfit"].values
        summary["interpolant_misfit"] = float(variables["misfit"].max())
    if "constrained" in files:
        summary["displacement_misfit"] = float(opened[files["constrained"]].attrs["displacement_misfit"])
    true, true_shape = None, None
    if truth is not None:
        true = material_of(truth)
        true_shape = _judge_truth(truth, true, found, mesh, F, kind, variables, summary)
        if "constrained" in files:
            _judge_constrained(opened[files["constrained"]], mesh, F, kind, variables, summary)
    elif printed:
        flipped = config.specimens[case.specimen].shape_flipped
        true_shape = _judge_printed(printed, flipped, measurement, mesh, shape, summary)
    if "constrained" in files:
        _judge_spread(opened[files["constrained"]], mesh, kind, shape_stretch, true, variables, summary)
    _judge_shape(mesh, field, shape, true_shape, variables, summary)
    places = X[most_interior(mesh, shape if true is None else true_shape)]
    _judge_curves(found, true, places, np.linspace(1.0, largest, CURVE_POINTS), kind, variables, summary)
    if "F_truth" in measurement:
        _judge_noise(mesh, measurement, {"smoothed": gradient["F"].values, "used": F_seen}, variables, summary)
    write(
        output,
        variables,
        f"evaluation of {name}",
        {
            **attributes,
            "units": units_of(measurement),
            "thickness": float(measurement.attrs["thickness"]),
            "modes": MODES,
            "load": kind,
            "shape_stretch": shape_stretch,
            "raw_inputs": {printed: sha256(printed)} if printed else {},
            "summary": summary,
        },
        parents=opened,
    )
