"""Homogeneous sheets and other frames with what was identified, against their tests (paper: experimental_example)."""

import json

import matplotlib.pyplot as plt
import numpy as np

from hypernode.fem.mesh import EDGE_NAMES
from hypernode.figures.style import INCLUSION, MATRIX, RC, save, unit_label
from hypernode.storage.netcdf import read, units_of

#: Reference -> its colour and what stands for it.
SHOWN = {"matrix": (MATRIX, "matrix"), "inclusion": (INCLUSION, "inclusion"), "whole": ("black", "field")}


def draw(inputs: dict[str, str], files: dict[str, str], settings: dict, provenance: dict) -> None:
    """Force against mean stretch: measured on each sheet, and computed with the identified phase.

    Args:
        inputs: ``references``: the file of the stage.
        files: format -> path.
        settings: ``case`` and ``method``.
        provenance: what the job says of itself.
    """
    data = read(inputs["references"])
    tests, summary = (json.loads(data.attrs[key]) for key in ("load_cases", "summary"))
    axis = 0 if data.attrs["load"].endswith("x") else 1
    edge = EDGE_NAMES.index(("right", "top")[axis])
    units = units_of(data)
    with plt.rc_context(RC):
        figure, axes = plt.subplots(figsize=(3.4, 3.5), layout="constrained")
        for index, label in enumerate(tests):
            phase = label.split(":")[0]
            colour, shown = SHOWN[phase]
            steps = data["load_case"].values == index
            stretch = np.concatenate([[1.0], data["stretch"].values[steps]])
            measured, found = (
                np.concatenate([[0.0], data[key].values[steps, edge, axis]])
                for key in ("edge_force", "edge_force_identified")
            )
            error = 100 * summary[f"reference_nrmse_{phase}"]
            axes.plot(stretch, measured, "o", color=colour, mfc="none", label=f"{label}, measured")
            axes.plot(stretch, found, "-", color=colour, label=f"identified {shown} (error {error:.1f} %)")
        axes.set_xlabel("mean stretch [-]")
        axes.set_ylabel("force" + unit_label(units["force"]))
        axes.set_ylim(bottom=0.0)
        # Above the axes: inside, a legend of six lines hides points.
        figure.legend(loc="outside upper left", frameon=False)
        save(figure, files, provenance, inputs.values())
