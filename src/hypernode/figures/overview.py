"""The pipeline drawn with a case's own fields (paper: fig_summary)."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch

from hypernode.figures.style import (
    FIELD_MAP,
    INCLUSION,
    MATRIX,
    NEUTRAL,
    RC,
    STRAIN_MAP,
    draw_field,
    outline,
    save,
    shared_norm,
    unit_label,
)
from hypernode.storage.netcdf import read, units_of


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
    """Stress-stretch curves of the two marked points, with the truth where it is known."""
    component = 1 if data.attrs["load"].endswith("_y") else 0
    for index, (colour, name) in enumerate(((MATRIX, "matrix"), (INCLUSION, "inclusion"))):
        curve.plot(
            data["curve_stretch"].values,
            data["curve_identified"].values[index, :, component],
            color=colour,
            label=name,
        )
        if "curve_true" in data:
            curve.plot(
                data["curve_stretch"].values[::2],
                data["curve_true"].values[index, ::2, component],
                "o",
                color=colour,
                mfc="none",
                ms=3,
            )
    curve.set_xlabel("stretch [-]", fontsize=7)
    curve.set_ylabel("$P$" + unit_label(units_of(data)["stress"]), fontsize=7)
    curve.set_title("lines identified, circles true", fontsize=6)
    curve.legend(frameon=False, fontsize=6)


def draw(inputs: dict[str, str], files: dict[str, str], settings: dict, provenance: dict) -> None:
    """From displacements to a material: measured u, F, its network, the material field and two of its curves.

    Args:
        inputs: ``measurement``, ``evaluation``: paths.
        files: format -> path.
        settings: ``step`` is the load step drawn.
        provenance: what the job says of itself.
    """
    measurement, data, step = read(inputs["measurement"]), read(inputs["evaluation"]), settings["step"]
    units = units_of(data)
    u = measurement["u_measured"].values.mean(axis=0)[step]
    size = np.linalg.norm(u, axis=1)[data["cells"].values].mean(axis=1)
    found = data["trace_P"].values
    with plt.rc_context(RC):
        figure = plt.figure(figsize=(7.2, 3.9))
        fields = (
            ([0.02, 0.55, 0.2, 0.34], size, "viridis", f"measured displacement, |u|{unit_label(units['length'])}"),
            (
                [0.29, 0.55, 0.2, 0.34],
                data["principal_strain"].values[step],
                STRAIN_MAP,
                "deformation gradient F(X, t)",
            ),
            ([0.02, 0.06, 0.2, 0.34], found, FIELD_MAP, f"material: tr P at {data.attrs['shape_stretch']:.3g}"),
        )
        for place, values, colours, title in fields:
            axes = figure.add_axes(place)
            mappable = draw_field(axes, data, values, shared_norm(values), colours)
            axes.set_xticks([])
            axes.set_yticks([])
            axes.set_title(title, fontsize=7)
            bar = figure.colorbar(mappable, ax=axes, fraction=0.046, pad=0.03)
            bar.ax.tick_params(labelsize=5)
            bar.outline.set_visible(False)
        outline(axes, data, data["shape"].values)
        for (x, y), colour in zip(data["curve_location"].values, (MATRIX, INCLUSION), strict=True):
            axes.plot(x, y, "s", color=colour, mec="white", ms=4)
        _box(figure, (0.56, 0.66, 0.17, 0.12), "hyper-network\nX $\\to$ weights of the\nneural ODEs")
        _box(figure, (0.8, 0.66, 0.18, 0.12), "neural ODEs\ninvariants $\\to$ $\\partial\\Psi/\\partial I_k$")
        _box(figure, (0.8, 0.36, 0.18, 0.14), "stress $P(X, F)$\nDiv $P$ = 0, edge forces\n= load cell")
        _curves(figure.add_axes([0.38, 0.12, 0.28, 0.28]), data)
        for start, end in (
            ((0.262, 0.72), (0.287, 0.72)),
            ((0.532, 0.72), (0.556, 0.72)),
            ((0.735, 0.72), (0.795, 0.72)),
            ((0.89, 0.655), (0.89, 0.51)),
            ((0.8, 0.4), (0.675, 0.3)),
            ((0.288, 0.25), (0.262, 0.25)),
        ):
            _arrow(figure, start, end)
        save(figure, files, provenance, inputs.values())
