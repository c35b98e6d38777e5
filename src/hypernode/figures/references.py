"""Homogeneous sheets and other frames with what was identified, against their tests (paper: experimental_example)."""

import json

import matplotlib.pyplot as plt
import numpy as np

from hypernode.fem.mesh import EDGE_NAMES
from hypernode.figures.style import INCLUSION, MATRIX, SECOND, force_label, from_zero
from hypernode.mechanics.loads import tensile_axis
from hypernode.storage.netcdf import units_of
from hypernode.tables.columns import significant

#: Reference -> its colour, marker and what stands for it.
SHOWN = {
    "matrix": (MATRIX, "o", "matrix"),
    "inclusion": (INCLUSION, "s", "inclusion"),
    "whole": (SECOND, "^", "whole field"),
}


def draw(data, settings: dict):
    """Force against mean stretch: measured on each sheet, and computed with the identified phase.

    Args:
        data: ``references``: the opened file of the stage.
        settings: ``case`` and ``method``.
    """
    file = data["references"]
    tests, summary = (json.loads(file.attrs[key]) for key in ("load_cases", "summary"))
    axis = tensile_axis(file.attrs["load"]) or 0
    edge = EDGE_NAMES.index(("right", "top")[axis])
    figure, axes = plt.subplots(figsize=(3.6, 3.7), layout="constrained")
    for index, label in enumerate(tests):
        phase, sheet = label.split(": ")
        colour, marker, shown = SHOWN[phase]
        steps = file["load_case"].values == index
        stretch = np.concatenate([[1.0], file["stretch"].values[steps]])
        measured, found = (
            np.concatenate([[0.0], file[key].values[steps, edge, axis]])
            for key in ("edge_force", "edge_force_identified")
        )
        error = summary[f"reference_nrmse_{phase}"]
        axes.plot(stretch, measured, marker, color=colour, mfc="none", ms=5, label=f"measured, {sheet}")
        known = error == error
        judged = f"identified {shown}, NRMSE {significant(100 * error)} %" if known else f"no {shown} was found"
        axes.plot(stretch, found, "-", color=colour, label=judged)
    axes.set_xlabel("mean stretch [-]")
    axes.set_ylabel("edge force" + force_label(units_of(file)))
    from_zero(axes)
    # Below the axes: inside, a legend of six lines hides points, and above is where a warning stands.
    figure.legend(loc="outside lower left")
    return figure
