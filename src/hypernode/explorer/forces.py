"""Measured forces against those of what was identified: of the test itself, and of sheets of one phase each."""

import json
from collections.abc import Mapping

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.data.measurement import mesh_of, relaxation, stress_resultants
from hypernode.evaluation.curves import LOCATIONS
from hypernode.fem.mesh import EDGE_NAMES
from hypernode.mechanics.loads import tensile_axis

#: Edges whose resultants are listed; those of the others follow by balance.
LISTED = ("right", "top")
#: Resultants below this share of the largest are left out.
NO_FORCE = 1e-3


def force_numbers(evaluation: xr.Dataset) -> list[dict]:
    """Resultants of every step: ``step``, ``name``, ``measured``, ``identified`` and ``error`` [%].

    The identified one is of the stress at the identified deformation; the error is over the largest resultant of its
    step.
    """
    measured, found = (evaluation[key].values for key in ("edge_force", "edge_force_at_identified"))
    if not np.isfinite(measured).any():
        return []
    largest = np.nanmax(np.abs(measured))
    rows = []
    for step in range(len(measured)):
        for edge in map(EDGE_NAMES.index, LISTED):
            for i, component in enumerate("xy"):
                force, identified = measured[step, edge, i], found[step, edge, i]
                if not abs(force) >= NO_FORCE * largest or not np.isfinite(identified):
                    continue
                error = 100.0 * (identified - force) / np.nanmax(np.abs(measured[step]))
                numbers = {"measured": float(force), "identified": float(identified), "error": float(error)}
                rows.append({"step": step, "name": f"f{component}, {EDGE_NAMES[edge]} edge", **numbers})
    return rows


def sheets_of_one_phase(files: Mapping[str, xr.Dataset]) -> list[dict]:
    """Nominal stress of homogeneous sheets against their mean stretch: measured, and computed with a phase.

    Args:
        files: ``references`` and ``sheet_<phase>``, the measurement of each sheet; without, there are none.

    Returns:
        Of each sheet ``phase``, ``name``, ``axis``, ``clamped``, ``stretch``, ``measured`` and ``computed``: force over
        its section at rest, without what of it is a matter of time.
    """
    if "references" not in files:
        return []
    references, found = files["references"], []
    axis = tensile_axis(references.attrs["load"])
    for index, label in enumerate(json.loads(references.attrs["load_cases"])):
        phase, name = label.split(": ")
        sheet = files.get(f"sheet_{phase}")
        if phase not in LOCATIONS or sheet is None or axis is None:
            continue
        steps = references["load_case"].values == index
        elastic = references["edge_force_identified"].values[steps] / relaxation(sheet)
        found.append(
            {
                **{"phase": phase, "name": name, "axis": axis},
                "clamped": "clamped" in references.attrs["load"],
                "stretch": references["stretch"].values[steps].tolist(),
                "measured": _nominal(sheet, stress_resultants(sheet), axis),
                "computed": _nominal(sheet, elastic / float(sheet.attrs["thickness"]), axis),
            }
        )
    return found


def _nominal(sheet: xr.Dataset, resultant: Float[np.ndarray, "step edge 2"], axis: int) -> list[float | None]:
    """Resultants along an axis over the width across it; None where there is none."""
    pulled = resultant[:, EDGE_NAMES.index(LISTED[axis]), axis] / mesh_of(sheet).size[1 - axis]
    return [float(value) if np.isfinite(value) else None for value in pulled]
