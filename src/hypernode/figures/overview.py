"""The pipeline drawn with a case's own fields (paper: fig_summary)."""

from itertools import pairwise

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
    interpolated,
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


#: Lower edge and size of the maps and of the boxes, as shares of the figure.
UPPER, LOWER, MAP = 0.595, 0.135, (0.169, 0.265)
#: Left edges of the maps of displacement, of measured and of used strain, and of the boxes.
LEFT, BOX = (0.02, 0.27, 0.52), (0.785, 0.185, 0.125)


def _map(figure, data, place, values, norm, colours, title):
    """(axes, mappable) of one field; ``place`` is its lower left corner."""
    axes = figure.add_axes([*place, *MAP])
    mappable = draw_field(axes, data, values, norm, colours)
    axes.set_xticks([])
    axes.set_yticks([])
    axes.set_title(title)
    return axes, mappable


def _bar(figure, left, right, mappable, label):
    """A colour bar below maps, from the first to the last, which keep their size."""
    x, y, _, _ = left.get_position().bounds
    cax = figure.add_axes([x, y - 0.03, right.get_position().x1 - x, 0.015])
    colour_bar(figure, None, mappable, label, cax=cax, orientation="horizontal")


def draw(data, settings: dict):
    """From displacements to a material: measured u, strains of its F and of the F that is used, networks, response.

    Both strains share their colours.

    Args:
        data: ``measurement``, ``field``, ``evaluation``: opened files.
        settings: ``step`` is the load step drawn.
    """
    measurement, evaluation, step = data["measurement"], data["evaluation"], settings["step"]
    units = units_of(evaluation)
    u = measurement["u_measured"].values.mean(axis=0)[step]
    size = np.linalg.norm(u, axis=1)[evaluation["cells"].values].mean(axis=1)
    measured, used = (evaluation[f"principal_strain_{key}"].values[step] for key in ("measured", "identified"))
    found = evaluation["trace_P"].values
    figure = plt.figure(figsize=(7.2, 4.6))
    panel, shown = _map(
        figure, evaluation, (LEFT[0], UPPER), size, shared_norm(size), FIELD_MAP, "measured displacement"
    )
    _bar(figure, panel, panel, shown, "$|u|$" + unit_label(units["length"]))
    strain = shared_norm(measured, used)
    first, _ = _map(figure, evaluation, (LEFT[1], UPPER), measured, strain, STRAIN_MAP, "measured $F$")
    name = "interpolated $F$" if interpolated(data["field"]) else "$F$ that is used"
    second, shown = _map(figure, evaluation, (LEFT[2], UPPER), used, strain, STRAIN_MAP, name)
    _bar(figure, first, second, shown, "max. principal strain [-]")
    title = f"material, all at {evaluation.attrs['shape_stretch']:.3g}"
    last, shown = _map(figure, evaluation, (LEFT[0], LOWER), found, shared_norm(found), FIELD_MAP, title)
    _bar(figure, last, last, shown, indicator_label(evaluation.attrs["load"], units))
    outline(last, evaluation, evaluation["shape"].values)
    mark_places(last, evaluation)
    x, width, height = BOX
    boxes = (
        (0.68, "hyper-network\n$X$ $\\to$ weights of\nneural ODEs"),
        (0.46, "neural ODEs\ninvariants $\\to$ $\\partial\\Psi/\\partial I_k$"),
        (0.24, "stress $P(X, F)$\nDiv $P$ = 0, edge\nforces = load cell"),
    )
    for y, text in boxes:
        _box(figure, (x, y, width, height), text)
    _curves(figure.add_axes([0.42, 0.11, 0.3, 0.3]), evaluation)
    middle, beside = UPPER + 0.5 * MAP[1], x + 0.5 * width
    for start, end in (
        *(((left + MAP[0] + 0.012, middle), (right - 0.012, middle)) for left, right in pairwise((*LEFT, x))),
        ((beside, 0.675), (beside, 0.59)),
        ((beside, 0.455), (beside, 0.37)),
        ((x - 0.012, 0.29), (0.735, 0.27)),
        ((0.32, 0.28), (0.225, 0.28)),
    ):
        _arrow(figure, start, end)
    return figure
