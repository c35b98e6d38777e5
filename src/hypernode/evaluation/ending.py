"""How the iteration for a constrained field ended, from its file."""

import json

import numpy as np
import xarray as xr

from hypernode.evaluation.explained import beside_corners, unexplained_share
from hypernode.evaluation.judgement import Judgement
from hypernode.evaluation.thresholds import SETTINGS


def score_ending(constrained: xr.Dataset) -> Judgement:
    """Ending, misfits of displacements and forces over their noise, and misfits of left-out steps.

    Raises:
        ValueError: the file does not say so.
    """
    missing = [key for key in ("ending", "misfits") if key not in constrained.attrs]
    if missing:
        raise ValueError(
            f"constrained.nc, {constrained.attrs.get('title', 'a constrained field')}: does not say how its descent "
            f"ended (no attribute {' or '.join(missing)}): it is of an older version; delete it and run again"
        )
    misfits = json.loads(constrained.attrs["misfits"])
    summary = {
        "ending": constrained.attrs["ending"],
        "displacement_misfit": float(misfits["displacement"]),
        "force_misfit": float(misfits["force"]),
    }
    if materials := int(constrained.attrs.get("materials", 0)):
        summary["materials"] = materials
    if "left_out" in constrained.attrs:
        left_out = json.loads(constrained.attrs["left_out"])
        summary["left_out_displacement_misfit"] = left_out["displacement"]
        if left_out["force"] is not None:
            summary["left_out_force_misfit"] = left_out["force"]
    if "unexplained" in constrained:
        summary["unexplained_share"] = unexplained_share(constrained, SETTINGS)
        summary["largest_local_misfit"] = float(
            np.nanmax(constrained["local_misfit"].values[~beside_corners(constrained)])
        )
    return Judgement(summary=summary)
