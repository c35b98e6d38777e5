"""What became of a hyper-network that was polished, as its file says."""

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
    """F[i, J, step, cell] that a method identified: in equilibrium with a polished network, or that of its field."""
    return field_gradient(material if "F" in material else field)


def score_polish(material: xr.Dataset) -> Judgement:
    """Whether a polished network is kept, and how its result misses load steps that it did not see, over their noise.

    Args:
        material: opened file of a material; nothing is said of one that no polishing left.
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
