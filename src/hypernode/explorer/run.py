"""One run as the page holds it: its verdict, fields, material and numbers."""

import json
from collections.abc import Mapping

import numpy as np
import xarray as xr

from hypernode.data.lost import sheet_displacement
from hypernode.data.measurement import mesh_of
from hypernode.explorer.facts import facts
from hypernode.explorer.forces import force_numbers, sheets_of_one_phase
from hypernode.explorer.laws import pack_material, pack_posterior
from hypernode.explorer.maps import maps_of
from hypernode.explorer.packing import Arrays
from hypernode.material.files import material_of, posterior_material
from hypernode.mechanics.loads import tensile_axis
from hypernode.storage.netcdf import units_of
from hypernode.tables.verdicts import RunVerdict
from hypernode.trace import HEAD, cells, read

#: Bits of the numbers of nodes.
COUNTING = 24


def packed_run(files: Mapping[str, xr.Dataset], arrays: Arrays) -> dict:
    """A run as plain data; fields and parameters go into ``arrays``.

    Args:
        files: opened ``evaluation``, ``material`` and ``measurement``; where there are any ``constrained``, ``truth``,
            ``references`` and ``sheet_<phase>``, the measurements of the sheets of one phase.

    Raises:
        ExplorerError: the law of a material has no text.
        VerdictError: the evaluation holds no verdict.
    """
    evaluation, measurement = files["evaluation"], files["measurement"]
    name, verdict = RunVerdict.of(evaluation)
    mesh, summary = mesh_of(evaluation), json.loads(evaluation.attrs["summary"])
    material = material_of(files["material"])
    true = material_of(files["truth"]) if "truth" in files else None
    posterior = posterior_material(files["constrained"]) if _has_basis(files) else None
    largest = float(summary.get("largest_stretch", evaluation["stretch"].values.max()))
    shown = maps_of(files, material, true)
    strain = evaluation["principal_strain_identified"].values.astype(float)
    return {
        "name": name,
        "units": units_of(evaluation),
        "verdict": _verdict(verdict),
        "nodes": arrays.add(mesh.nodes.T),
        "cells": arrays.add(mesh.cells.T, COUNTING),
        "shape": arrays.add(evaluation["shape"].values),
        "steps": _steps(measurement),
        "maps": [_packed_map(each, arrays) for each in shown],
        "displacement": arrays.add(np.moveaxis(sheet_displacement(measurement, files.get("constrained")), 1, 2)),
        "identified": pack_material(material, mesh.centres, largest, arrays),
        "truth": None if true is None else pack_material(true, mesh.centres, largest, arrays),
        "posterior": None if posterior is None else pack_posterior(posterior, mesh.centres, largest, arrays),
        "largest": largest,
        "seen": arrays.add(np.sqrt(1.0 + 2.0 * np.nanmax(strain, axis=0))),
        "shape_stretch": float(evaluation.attrs["shape_stretch"]),
        "forces": force_numbers(evaluation),
        "sheets": sheets_of_one_phase(files),
        "trace": _trace(files.get("constrained")),
        "doubt": json.loads(evaluation.attrs.get("doubt", "[]")),
        "budget": json.loads(evaluation.attrs.get("level_budget", "[]")),
        "facts": [list(each) for each in facts(summary)],
        "start": _start(evaluation, mesh),
    }


def _trace(constrained) -> dict | None:
    """Heads and rows of the candidates of a constrained field, or None where there is no record of them."""
    rows = [] if constrained is None else read(constrained.attrs)
    return {"heads": HEAD, "rows": cells(rows)} if rows else None


def _has_basis(files) -> bool:
    return "constrained" in files and "basis" in files["constrained"].attrs


def _verdict(verdict) -> dict:
    """The level, every criterion, and the suspects."""
    criteria = [{"name": c.name, "level": str(c.level), "sentence": c.sentence} for c in verdict.ranked]
    suspects = [{"name": each.name, "sentence": each.sentence} for each in verdict.suspects]
    return {"level": str(verdict.overall), "criteria": criteria, "suspects": suspects}


def _steps(measurement) -> list[str]:
    cases, stretches = json.loads(measurement.attrs["load_cases"]), measurement["stretch"].values
    numbers = measurement["load_case"].values
    return [f"{cases[number]} {stretch:.4g}" for number, stretch in zip(numbers, stretches, strict=True)]


def _packed_map(each, arrays: Arrays) -> dict:
    words = {key: getattr(each, key) for key in ("key", "title", "unit", "about", "colours", "least")}
    truth = None if each.truth is None else arrays.add(each.truth)
    return words | {"values": arrays.add(each.values), "truth": truth}


def _start(evaluation, mesh) -> dict:
    """What is shown first: a point of the inclusion, or of the matrix, pulled as the test was."""
    places = evaluation["curve_location"].values
    place = next((place for place in places[::-1] if np.isfinite(place).all()), mesh.centres.mean(axis=0))
    axis = tensile_axis(evaluation.attrs["load"])
    mode = "shear" if evaluation.attrs["load"] == "shear" else "equibiaxial" if axis is None else "uniaxial"
    cell = int(np.argmin(np.linalg.norm(mesh.centres - place, axis=1)))
    return {"cell": cell, "mode": mode, "direction": 90 * (axis or 0)}
