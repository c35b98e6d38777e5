"""The pipeline drawn with a case's own fields (paper: fig_summary)."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

from hypernode.figures.style import (
    FIELD_MAP,
    NEUTRAL,
    STRAIN_MAP,
    colour_bar,
    curve_places,
    draw_field,
    inclusion_note,
    indicator_label,
    is_biaxial,
    mark_places,
    outline,
    shared_norm,
    unit_label,
)
from hypernode.storage.netcdf import units_of


def _box(figure, place, text):
    x, y, w, h = place
    figure.patches.append(
        FancyBboxPatch(
            (x, y), w, h, boxstyle="round,pad=0.004", transform=figure.transFigure, fc="#F2F2F2", ec=NEUTRAL, lw=0.8
        )
    )
    figure.text(x + w / 2, y + h / 2, text, ha="center", va="center", fontsize=7)


def _arrow(figure, start, end):
    arrow = FancyArrowPatch(start, end, transform=figure.transFigure, arrowstyle="-|>", mutation_scale=9, color=NEUTRAL)
    figure.patches.append(arrow)


def _curves(curve, data):
    """Stress-stretch curves of the marked points, with the truth where it is known."""
    component = 1 if data.attrs["load"].endswith("_y") else 0
    for index, name, colour in curve_places(data):
        found = data["curve_identified"].values[index, :, component]
        curve.plot(data["curve_stretch"].values, found, color=colour, label=f"{name}, identified")
        if "curve_true" in data:
            true = data["curve_true"].values[index, ::2, component]
            stretch = data["curve_stretch"].values[::2]
            curve.plot(stretch, true, "o", color=colour, mfc="none", ms=3, label=f"{name}, truth")
    curve.set_xlabel(f"{'equibiaxial' if is_biaxial(data.attrs['load']) else 'uniaxial'} stretch [-]")
    curve.set_ylabel(f"$P_{{{'yY' if component else 'xX'}}}$" + unit_label(units_of(data)["stress"]))
    # Room for the legend above the curves, which fill both lower corners.
    curve.set_ylim(top=1.6 * curve.get_ylim()[1])
    curve.legend(loc="upper left", title=inclusion_note(data), title_fontsize="x-small", alignment="left")


def draw(data, settings: dict):
    """From displacements to a material: measured u, its strain, the networks, the material field and two curves.

    Args:
        data: ``measurement``, ``evaluation``: opened files.
        settings: ``step`` is the load step drawn.
    """
    measurement, evaluation, step = data["measurement"], data["evaluation"], settings["step"]
    units = units_of(evaluation)
    u = measurement["u_measured"].values.mean(axis=0)[step]
    size = np.linalg.norm(u, axis=1)[evaluation["cells"].values].mean(axis=1)
    strain, found = evaluation["principal_strain_measured"].values[step], evaluation["trace_P"].values
    stress = indicator_label(evaluation.attrs["load"], units)
    figure = plt.figure(figsize=(7.2, 4.2))
    fields = (
        ([0.02, 0.53, 0.2, 0.33], size, FIELD_MAP, "measured displacement", "$|u|$" + unit_label(units["length"])),
        ([0.33, 0.53, 0.2, 0.33], strain, STRAIN_MAP, "deformation", "max. principal strain [-]"),
        (
            [0.02, 0.07, 0.2, 0.33],
            found,
            FIELD_MAP,
            f"material, all at {evaluation.attrs['shape_stretch']:.3g}",
            stress,
        ),
    )
    for place, values, colours, title, label in fields:
        axes = figure.add_axes(place)
        mappable = draw_field(axes, evaluation, values, shared_norm(values), colours)
        axes.set_xticks([])
        axes.set_yticks([])
        axes.set_title(title)
        colour_bar(figure, axes, mappable, label)
    outline(axes, evaluation, evaluation["shape"].values)
    mark_places(axes, evaluation)
    _box(figure, (0.645, 0.63, 0.15, 0.13), "hyper-network\n$X$ $\\to$ weights of\nneural ODEs")
    _box(figure, (0.835, 0.63, 0.155, 0.13), "neural ODEs\ninvariants $\\to$ $\\partial\\Psi/\\partial I_k$")
    _box(figure, (0.835, 0.33, 0.155, 0.14), "stress $P(X, F)$\nDiv $P$ = 0, edge\nforces = load cell")
    _curves(figure.add_axes([0.44, 0.11, 0.29, 0.29]), evaluation)
    for start, end in (
        ((0.285, 0.695), (0.322, 0.695)),
        ((0.597, 0.695), (0.64, 0.695)),
        ((0.8, 0.695), (0.83, 0.695)),
        ((0.9125, 0.625), (0.9125, 0.475)),
        ((0.83, 0.4), (0.74, 0.31)),
        ((0.355, 0.235), (0.3, 0.235)),
    ):
        _arrow(figure, start, end)
    return figure
