"""Opened result files of a small sheet whose right half is twice as stiff, as figures take them."""

import json

import numpy as np
import xarray as xr

from hypernode.fem.mesh import EDGES

UNITS = {"length": "1", "stress": "Pa", "force": "Pa", "energy": "Pa"}
N, STRETCH = 4, np.array([1.05, 1.1])
COMMON = {"units": json.dumps(UNITS), "load": "equibiaxial", "shape_stretch": 1.1}


def _grid() -> dict:
    x, y = np.meshgrid(np.linspace(0.0, 1.0, N + 1), np.linspace(0.0, 1.0, N + 1))
    first = (np.arange(N) + (N + 1) * np.arange(N)[:, None]).ravel()
    return {
        "X": (("node", "i"), np.stack([x.ravel(), y.ravel()], axis=1)),
        "cells": (("cell", "vertex"), np.stack([first, first + 1, first + N + 2, first + N + 1], axis=1)),
        "corners": (("corner", "i"), np.array([[0.0, 0.0], [1.0, 1.0]])),
    }


def _right_half() -> np.ndarray:
    return np.tile(np.arange(N) >= N // 2, N)


def material(soft: float = 1.0) -> xr.Dataset:
    """A neo-Hookean sheet, as the file of a true material holds it."""
    mu = np.where(_right_half(), 2.0, soft)
    fields = {"material.mu": ("cell", mu), "material.model": ("cell", 0.0 * mu)}
    attributes = COMMON | {"material_kind": "closed_form", "models": json.dumps(["neo_hookean"])}
    return xr.Dataset(_grid() | fields, attrs=attributes)


#: What a verdict says of displacements at each level.
SENTENCES = {
    "fail": "The misfit of displacements over their noise is 3.21, more than 2.00.",
    "warn": "The misfit of displacements over their noise is 1.21, more than 1.05.",
    "pass": "The misfit of displacements over their noise is 1.01, no more than 1.05.",
}


def verdict(level: str) -> dict:
    """A verdict as evaluations hold it, of three criteria of which the last two say the same."""
    met = {"name": "law", "level": "pass", "sentence": "The law is met.", "value": 0.0, "threshold": 0.1}
    said = {"name": "displacements", "level": level, "sentence": SENTENCES[level], "value": 1.0, "threshold": 1.05}
    return {"overall": level, "criteria": [met, said, said | {"name": "forces"}]}


def evaluation(level: str = "pass", **attributes) -> xr.Dataset:
    """What a run is judged by; every number is its own."""
    rng = np.random.default_rng(0)
    cells, steps, points = N * N, len(STRETCH), 5

    def cell(*before):
        return rng.uniform(0.1, 1.0, (*before, cells))

    force = {f"edge_force{end}": rng.uniform(0.5, 1.0, (steps, len(EDGES), 2)) for end in ("", *_AT)}
    angles = {key: ("cell", cell()) for key in ("anisotropy", "anisotropy_true", "fibre_angle", "fibre_angle_true")}
    curve = ("location", "curve_point", "i")
    judged = {
        "run": json.dumps({"case": "half", "method": "m"}),
        "verdict": json.dumps(verdict(level)),
        "summary": json.dumps({"inclusion": "distinguishable"}),
    }
    return xr.Dataset(
        _grid()
        | {key: (("load_step", "edge", "i"), value) for key, value in force.items()}
        | angles
        | {
            "stretch": ("load_step", STRETCH),
            "principal_strain_measured": (("load_step", "cell"), cell(steps)),
            "principal_strain_identified": (("load_step", "cell"), cell(steps)),
            "P_field": (("load_step", "cell", "i", "J"), rng.uniform(0.1, 1.0, (steps, cells, 2, 2))),
            "trace_P": ("cell", cell()),
            "shape": ("cell", _right_half().astype(int)),
            "curve_location": (("location", "i"), np.array([[0.2, 0.5], [0.8, 0.5]])),
            "curve_stretch": ("curve_point", np.linspace(1.0, 1.1, points)),
            "curve_identified": (curve, rng.uniform(0.1, 1.0, (2, points, 2))),
            "curve_true": (curve, rng.uniform(0.1, 1.0, (2, points, 2))),
        },
        attrs=COMMON | judged | attributes,
    )


def detected(contrast: int, level: str = "pass") -> xr.Dataset:
    """A run of a sheet whose right half is this many times 10 % stiffer, found from 15 % on."""
    stiffness = 1.0 + 0.1 * contrast * _right_half()
    P = stiffness[:, None, None] * np.eye(2)
    said = "distinguishable" if contrast > 1 else "none distinguishable"
    summary = {"inclusion": said, "detectable_contrast": 0.15}
    truth = {
        "P_true": (("mode", "stretch_index", "cell", "i", "J"), P[None, None]),
        "phase": ("cell", _right_half() * 1),
    }
    return evaluation(level).assign(truth).assign_attrs(summary=json.dumps(summary))


def without_inclusion(judged: xr.Dataset) -> xr.Dataset:
    """The same run where no inclusion was distinguishable."""
    summary = {"inclusion": "none distinguishable", "detectable_contrast": 0.0345}
    known = xr.DataArray([1.0, np.nan], dims="location")
    drawn = ("curve_location", "curve_identified", "curve_true")
    fields = {name: judged[name] * known for name in drawn} | {"shape": 0 * judged["shape"]}
    transposed = {name: field.transpose(*judged[name].dims) for name, field in fields.items()}
    return judged.assign(transposed).assign_attrs(judged.attrs | {"summary": json.dumps(summary)})


_AT = ("_at_measured", "_at_identified")


def measurement() -> xr.Dataset:
    """The measured displacement of every node, and the true deformation gradient of every cell."""
    u = 0.1 * _grid()["X"][1] * np.ones((1, len(STRETCH), 1, 1))
    F = np.broadcast_to(1.1 * np.eye(2), (len(STRETCH), N * N, 2, 2))
    return xr.Dataset(
        {
            "u_measured": (("repeat", "load_step", "node", "i"), u),
            "F_truth": (("load_step", "cell", "i", "J"), F),
        }
    )


def field_used(amiss: float = 0.0) -> xr.Dataset:
    """The deformation gradient of an interpolant whose F_xX is wrong by so much in the stiffer half."""
    F = measurement()["F_truth"].values.copy()
    F[:, _right_half(), 0, 0] += amiss
    return xr.Dataset({"F_interpolated": (("load_step", "cell", "i", "J"), F)})


def references() -> xr.Dataset:
    """A sheet of each phase, pulled along x."""
    force = np.linspace(0.1, 1.0, 4 * len(EDGES) * 2).reshape(4, len(EDGES), 2)
    fields = {
        "load_case": ("load_step", np.array([0, 0, 1, 1])),
        "stretch": ("load_step", np.tile(STRETCH, 2)),
        "edge_force": (("load_step", "edge", "i"), force),
        "edge_force_identified": (("load_step", "edge", "i"), 1.1 * force),
    }
    attributes = {
        "load": "uniaxial_x",
        "load_cases": json.dumps(["matrix: soft", "inclusion: stiff"]),
        "summary": json.dumps({"reference_nrmse_matrix": 0.1, "reference_nrmse_inclusion": 0.1}),
    }
    return xr.Dataset(fields, attrs=COMMON | attributes)


def photographed() -> dict[str, xr.Dataset]:
    """Two pictures of the sheet in 16 pixels a side, whose points lie 4 apart; one is lost in the last."""
    places = np.arange(6.0, 23.0, 4.0)
    column, row = (each.ravel() for each in np.meshgrid(places, places[::-1]))
    correlation = np.linspace(0.9, 1.0, (1 + len(STRETCH)) * column.size).reshape(1 + len(STRETCH), -1)
    correlation[-1, 7] = np.nan
    pictures = {
        "picture": (("frame", "row", "column"), np.arange(3 * 28 * 28).reshape(3, 28, 28) % 256),
        "on_sheet": (("row", "column"), np.pad(np.ones((16, 16), int), 6)),
    }
    points = {
        "pixel_column": ("pixel_point", column),
        "pixel_row": ("pixel_point", row),
        "correlation": (("frame", "pixel_point"), correlation),
    }
    place = {"mm_per_pixel": 1.0 / 16.0, "origin_column": 6.0, "origin_row": 22.0, "correlation_step": 4, "subset": 5}
    u = measurement()["u_measured"].copy()
    u[0, -1, 7] = np.nan
    measured = _grid() | {
        "stretch": ("load_step", STRETCH),
        "u_measured": u,
        "u_truth": 1.1 * measurement()["u_measured"].isel(repeat=0),
    }
    return {
        "pictures": xr.Dataset(pictures, attrs=COMMON | place),
        "correlated": xr.Dataset(points, attrs=COMMON | place),
        "measurement": xr.Dataset(measured, attrs=COMMON),
    }


def figure_input(kind: str, level: str) -> tuple[dict, dict]:
    """(opened files, settings) of a figure of a kind, of a run with a verdict."""
    judged = {"evaluation": evaluation(level)}
    settings = {"kind": kind, "case": "half", "method": "m", "step": -1}
    if kind == "comparison":
        runs = [{"case": "half", "method": name, "label": name} for name in ("first", "second")]
        settings = {"kind": kind, "runs": runs, "stretches": [1.05, 1.1], "load": "equibiaxial", "show": "stress"}
        data = {"run0": material(), "run1": material(1.5), "truth0": material(), "truth1": material()}
        return data | {"evaluation0": evaluation("pass"), "evaluation1": evaluation(level)}, settings
    if kind == "deformation":
        runs = [{"case": "half", "method": name, "label": name} for name in ("first", "second")]
        data = {"evaluation0": evaluation("pass"), "evaluation1": evaluation(level)}
        data |= {f"measurement{k}": measurement() for k in range(2)}
        return data | {"field0": field_used(), "field1": field_used(0.02)}, {"kind": kind, "runs": runs, "step": -1}
    if kind == "detection":
        return {f"evaluation{k}": detected(k, level) for k in range(4)}, {"kind": kind, "runs": ["*"]}
    if kind == "pictures":
        return photographed(), {"kind": kind, "case": "half", "step": -1}
    more = {
        "identification": {"truth": material()},
        "anisotropy": {
            **{"truth": material(), "material": material(1.2)},
            **{"measurement": measurement(), "field": field_used(0.01)},
        },
        "overview": {"measurement": measurement(), "field": field_used(0.01)},
        "references": {"references": references()},
    }
    return judged | more[kind], settings
