"""The figure of one identification (paper: p_example and experimental_example, panels a to f)."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from hypernode.evaluation.probes import indicator
from hypernode.fem.mesh import EDGES
from hypernode.figures.style import (
    NEUTRAL,
    SECOND,
    STRAIN_MAP,
    colour_bar,
    curve_places,
    draw_field,
    force_label,
    from_zero,
    inclusion_note,
    indicator_label,
    is_biaxial,
    mark_places,
    outline,
    shared_norm,
    unit_label,
)
from hypernode.material.files import material_of
from hypernode.mechanics.loads import tensile_axis
from hypernode.storage.netcdf import units_of

#: Resultants below this share of the largest are not drawn.
NO_FORCE = 1e-3
#: Percentiles of the identified stress between which colours differ.
USUAL = (1.0, 99.0)
#: Edge forces: variable -> (marker, words).
FORCES = {
    "edge_force": ("o", "measured"),
    "edge_force_at_identified": ("x", "at identified $F$"),
    "edge_force_at_measured": ("+", "at measured $F$"),
}


def _forces(axes, data, units):
    """Panel e: resultants of the measured edges against the stretch, at both deformations."""
    measured, drawn = data["edge_force"].values, []
    for edge, name in enumerate(EDGES):
        for i, component in enumerate("xy"):
            force = np.abs(measured[:, edge, i])
            if name not in ("right", "top") or not np.isfinite(force).any():
                continue
            if np.nanmax(force) < NO_FORCE * np.nanmax(np.abs(measured)):
                continue
            # In two sizes, since two edges of an equibiaxial test may carry the same.
            colour, size = ((NEUTRAL, 6.5), (SECOND, 4.0))[len(drawn) % 2]
            for variable, (marker, _) in FORCES.items():
                values = data[variable].values[:, edge, i]
                axes.plot(data["stretch"].values, values, marker, color=colour, ms=size, mfc="none", lw=0)
            drawn.append(Line2D([], [], color=colour, lw=3, label=f"$f_{component}$, {name} edge"))
    kinds = [
        Line2D([], [], color="black", marker=marker, ms=4, mfc="none", lw=0, label=words)
        for marker, words in FORCES.values()
    ]
    axes.set_xlabel("edge stretch [-]")
    axes.set_ylabel("edge force" + force_label(units))
    axes.margins(x=0.12)
    axes.locator_params(axis="x", nbins=4)
    from_zero(axes)
    # Each line of the legend takes a ninth of the height, above the largest force.
    lines = len(kinds) + len(drawn)
    axes.set_ylim(top=axes.get_ylim()[1] + np.ptp(axes.get_ylim()) * lines / (9.0 - lines))
    axes.legend(handles=[*kinds, *drawn], loc="upper left")


def _curves(axes, data, units):
    """Panel f: stress against stretch at a point of the matrix and, where there is one, of the inclusion."""
    kind, stretch, found = data.attrs["load"], data["curve_stretch"].values, data["curve_identified"].values
    component = tensile_axis(kind) or 0
    for index, name, colour in curve_places(data):
        axes.plot(stretch, found[index, :, component], color=colour, label=f"{name}, identified")
        if "curve_true" in data:
            true = data["curve_true"].values[index, ::2, component]
            axes.plot(stretch[::2], true, "o", color=colour, ms=3, mfc="none", label=f"{name}, truth")
    axes.set_xlabel(f"{'equibiaxial' if is_biaxial(kind) else 'uniaxial'} stretch [-]")
    axes.set_ylabel(f"$P_{{{'xX' if component == 0 else 'yY'}}}$" + unit_label(units["stress"]))
    # Room for the legend above the curves, which fill both lower corners.
    axes.set_ylim(top=2.1 * axes.get_ylim()[1])
    axes.legend(loc="upper left", title=inclusion_note(data), title_fontsize="x-small", alignment="left")


def _materials(figure, truth_axes, found_axes, data, truth, label):
    """Panels c and d: the true material or printed shape, and the identified material, on one scale."""
    found, kind = data["trace_P"].values, data.attrs["load"]
    # Single cells that are far off would take the whole scale.
    usual = np.percentile(found, USUAL)
    if truth is not None:
        centres = data["X"].values[data["cells"].values].mean(axis=1)
        true = indicator(material_of(truth), centres, kind, data.attrs["shape_stretch"])
        norm = shared_norm(usual, true)
        colour_bar(figure, truth_axes, draw_field(truth_axes, data, true, norm), label)
    else:
        norm = shared_norm(usual)
        if "shape_true" in data:
            draw_field(truth_axes, data, data["shape_true"].values.astype(float), shared_norm([0.0, 1.0]), "Greys_r")
        else:
            truth_axes.axis("off")
    colour_bar(figure, found_axes, draw_field(found_axes, data, found, norm), label)
    outline(found_axes, data, data["shape"].values)
    mark_places(found_axes, data)


def draw(data, settings: dict):
    """Draw strain, equilibrated stress, truth, identified field, forces and curves.

    Args:
        data: ``evaluation`` and, for synthetic cases, ``truth``: opened files.
        settings: ``step`` is the load step of panels a and b.
    """
    evaluation, truth, step = data["evaluation"], data.get("truth"), settings["step"]
    units, kind, stretch = units_of(evaluation), evaluation.attrs["load"], evaluation.attrs["shape_stretch"]
    label, length = indicator_label(kind, units), unit_label(units["length"])
    figure, grid = plt.subplots(2, 3, figsize=(7.2, 4.5), layout="constrained")
    a, b, c, d, e, f = grid.ravel()
    strain = evaluation["principal_strain_measured"].values[step]
    shown = draw_field(a, evaluation, strain, shared_norm(strain), STRAIN_MAP)
    colour_bar(figure, a, shown, "max. principal strain [-]")
    P = evaluation["P_field"].values[step]
    axis = tensile_axis(kind)
    normal = np.trace(P, axis1=1, axis2=2) if axis is None else P[:, axis, axis]
    shown = draw_field(b, evaluation, normal, shared_norm(np.percentile(normal, USUAL)))
    colour_bar(figure, b, shown, label)
    _materials(figure, c, d, evaluation, truth, label)
    _forces(e, evaluation, units)
    _curves(f, evaluation, units)
    at = f"{evaluation['stretch'].values[step]:.3g}"
    known = (
        f"truth, all at {stretch:.3g}" if truth is not None else "printed shape" if "shape_true" in evaluation else ""
    )
    titles = (
        f"measured strain at {at}",
        f"identified stress at {at}",
        known,
        f"identified, all at {stretch:.3g}",
        "edge forces",
        f"response at {'two points' if len(curve_places(evaluation)) == 2 else 'one point'}",
    )
    for letter, axes, title in zip("abcdef", grid.ravel(), titles, strict=True):
        axes.set_title(f"({letter}) {title}" if title else "", loc="left")
        if letter in "abcd":
            axes.set_xlabel("$X$" + length)
            axes.set_ylabel("$Y$" + length)
        else:
            axes.set_box_aspect(1)
    return figure
