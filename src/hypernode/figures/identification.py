"""The figure of one identification (paper: p_example and experimental_example, panels a to f)."""

import matplotlib.pyplot as plt
import numpy as np

from hypernode.fem.mesh import EDGES
from hypernode.figures.style import (
    FIELD_MAP,
    INCLUSION,
    MATRIX,
    NEUTRAL,
    RC,
    STRAIN_MAP,
    colour_bar,
    draw_field,
    outline,
    save,
    shared_norm,
    unit_label,
)
from hypernode.storage.netcdf import read, units_of


def _forces(axes, data, units):
    """Panel e: resultant of every measured edge and component against the stretch."""
    stretch, measured, found = (data[k].values for k in ("stretch", "edge_force", "edge_force_identified"))
    drawn = 0
    for edge, name in enumerate(EDGES):
        for i, component in enumerate("xy"):
            if name not in ("right", "top") or not np.isfinite(measured[:, edge, i]).any():
                continue
            if np.nanmax(np.abs(measured[:, edge, i])) < 1e-3 * np.nanmax(np.abs(measured)):
                continue
            colour = (NEUTRAL, "#009E73")[drawn % 2]
            axes.plot(
                stretch,
                measured[:, edge, i],
                "o",
                color=colour,
                ms=4,
                mfc="none",
                label=f"$f_{component}$, {name}, measured",
            )
            axes.plot(stretch, found[:, edge, i], "x", color=colour, ms=4, label=f"$f_{component}$, {name}, identified")
            drawn += 1
    axes.set_xlabel("edge stretch [-]")
    axes.set_ylabel("force" + unit_label(f"{units['force']} · length" if units["length"] == "1" else units["force"]))
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False, loc="lower right", fontsize=6, handlelength=1.2)


def _curves(axes, data, units):
    """Panel f: stress against stretch at a point of the matrix and one of the inclusion."""
    stretch, found = data["curve_stretch"].values, data["curve_identified"].values
    true = data["curve_true"].values if "curve_true" in data else None
    component = 0 if data.attrs["load"] in ("equibiaxial", "biaxial", "uniaxial_x", "clamped_x") else 1
    for index, (name, colour) in enumerate((("matrix", MATRIX), ("inclusion", INCLUSION))):
        axes.plot(stretch, found[index, :, component], color=colour, label=f"{name}, identified")
        if true is not None:
            axes.plot(
                stretch[::2], true[index, ::2, component], "o", color=colour, ms=3, mfc="none", label=f"{name}, truth"
            )
    mode = "equibiaxial" if data.attrs["load"] in ("equibiaxial", "biaxial", "shear") else "uniaxial"
    axes.set_xlabel(f"{mode} stretch [-]")
    axes.set_ylabel(f"$P_{{{'xX' if component == 0 else 'yY'}}}$" + unit_label(units["stress"]))
    # Room for the legend above the curves, which fill both lower corners.
    axes.set_ylim(top=1.5 * axes.get_ylim()[1])
    axes.legend(frameon=False, loc="upper left", fontsize=6, handlelength=1.2)


def draw(inputs: dict[str, str], files: dict[str, str], settings: dict, provenance: dict) -> None:
    """Draw strain, equilibrated stress, truth, identified field, forces and curves.

    Args:
        inputs: ``evaluation`` and, for synthetic cases, ``truth``: paths.
        files: format -> path.
        settings: ``step`` is the load step of panels a and b.
        provenance: what the job says of itself.
    """
    step = settings["step"]
    data = read(inputs["evaluation"])
    units = units_of(data)
    kind, stretch = data.attrs["load"], data.attrs["shape_stretch"]
    biaxial = kind in ("equibiaxial", "biaxial", "shear")
    stress_label = ("tr $P$" if biaxial else "$P_{xX}$" if kind.endswith("x") else "$P_{yY}$") + unit_label(
        units["stress"]
    )
    length = unit_label(units["length"])
    with plt.rc_context(RC):
        figure, grid = plt.subplots(2, 3, figsize=(7.2, 4.4), layout="constrained")
        panels = dict(zip("abcdef", grid.ravel(), strict=True))
        strain = data["principal_strain"].values[step]
        shown = draw_field(panels["a"], data, strain, shared_norm(strain), STRAIN_MAP)
        colour_bar(figure, panels["a"], shown, "max. principal strain [-]")
        P = data["P_field"].values[step]
        normal = P[:, 0, 0] + P[:, 1, 1] if biaxial else P[:, 0, 0] if kind.endswith("x") else P[:, 1, 1]
        shown = draw_field(panels["b"], data, normal, shared_norm(np.percentile(normal, [1, 99])))
        colour_bar(figure, panels["b"], shown, stress_label)
        found = data["trace_P"].values
        if "P_true" in data:
            true = _true_indicator(inputs["truth"], data)
            norm = shared_norm(found, true)
            shown = draw_field(panels["c"], data, true, norm)
            colour_bar(figure, panels["c"], shown, stress_label)
        else:
            norm = shared_norm(found)
            if "shape_true" in data:
                printed = data["shape_true"].values.astype(float)
                draw_field(panels["c"], data, printed, shared_norm([0.0, 1.0]), "Greys_r")
            else:
                panels["c"].axis("off")
        shown = draw_field(panels["d"], data, found, norm, FIELD_MAP)
        outline(panels["d"], data, data["shape"].values)
        colour_bar(figure, panels["d"], shown, stress_label)
        for (x, y), colour in zip(data["curve_location"].values, (MATRIX, INCLUSION), strict=True):
            panels["d"].plot(x, y, "s", color=colour, mec="white", ms=5)
        _forces(panels["e"], data, units)
        _curves(panels["f"], data, units)
        truth_title = "true material" if "P_true" in data else "printed shape"
        titles = {
            "a": f"strain at {data['stretch'].values[step]:.3g}",
            "b": f"identified stress at {data['stretch'].values[step]:.3g}",
            "c": truth_title + (f", all at {stretch:.3g}" if "P_true" in data else ""),
            "d": f"identified, all at {stretch:.3g}",
            "e": "edge forces",
            "f": "stress-stretch",
        }
        for key, axes in panels.items():
            axes.set_title(f"({key}) {titles[key]}", loc="left")
            if key in "abcd":
                axes.set_xlabel("X" + length)
                axes.set_ylabel("Y" + length)
        save(figure, files, provenance, inputs.values())


def _true_indicator(truth_file, data):
    """The true counterpart of the indicator field."""
    from hypernode.evaluation.probes import indicator
    from hypernode.material.files import load_material

    centres = data["X"].values[data["cells"].values].mean(axis=1)
    return indicator(load_material(truth_file), centres, data.attrs["load"], data.attrs["shape_stretch"])
