"""Result of polishing a hyper-network, from its file."""

import json
import math

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.data.measurement import field_gradient
from hypernode.evaluation.judgement import Judgement

#: Words for a polished network that is the result, and for one that is not.
KEPT, NOT_KEPT = "kept", "not kept"


def identified_gradient(field: xr.Dataset, material: xr.Dataset) -> Float[np.ndarray, "2 2 step cell"]:
    """Identified F[i, J, step, cell]: in equilibrium with the polished network, or that of the field."""
    return field_gradient(material if "F" in material else field)


def score_polish(material: xr.Dataset) -> Judgement:
    """Whether a polished network is kept, and its misfit of held-out load steps over their noise.

    Args:
        material: opened file of a material; the result is empty if it was not polished.
    """
    if "polished" not in material.attrs:
        return Judgement()
    found = json.loads(material.attrs["polished"])
    held_out = found["misfits"].get("held_out", {})
    before = held_out.get("before", {})
    result = held_out["after"] if found["kept"] else before
    summary = {"polish": KEPT if found["kept"] else NOT_KEPT, "polish_reason": found["reason"]}
    for name in ("displacement", "force"):
        summary[f"held_out_{name}_misfit"] = float(result.get(name, math.nan))
        summary[f"held_out_{name}_misfit_before"] = float(before.get(name, math.nan))
    if found["ending"]:
        summary["polish_ending"] = found["ending"]
    return Judgement(summary=summary)
