"""One look for every figure: fonts, colours, field maps, labels, saving."""

import json

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize

from hypernode.evaluation.phases import NONE
from hypernode.mechanics.loads import tensile_axis
from hypernode.storage.netcdf import write_bytes_atomically
from hypernode.tables.columns import significant

#: Okabe-Ito colours, told apart with any colour vision.
MATRIX, INCLUSION, NEUTRAL, SECOND = "#0072B2", "#D55E00", "#444444", "#009E73"
FIELD_MAP, STRAIN_MAP, ERROR_MAP, ANGLE_MAP = "viridis", "cividis", "magma", "twilight"

RC = {
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "legend.fontsize": 6.5,
    "legend.frameon": False,
    "legend.handlelength": 1.4,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "pdf.fonttype": 42,
    "svg.hashsalt": "hypernode",
    "figure.dpi": 150,
    "savefig.dpi": 300,
}
#: What files of a format say of themselves: no date, so that the same figure is the same file.
METADATA = {
    "pdf": {"CreationDate": None, "Producer": None, "Creator": "hypernode"},
    "png": {"Software": "hypernode"},
}


def draw_field(axes, data, values, norm: Normalize, cmap: str = FIELD_MAP):
    """Draw one value a cell in the reference configuration; returns the mappable for a colour bar."""
    corners = data["X"].values[data["cells"].values]
    cells = PolyCollection(corners, array=np.ma.asarray(values), cmap=cmap, norm=norm, rasterized=True)
    cells.set_edgecolor("face")
    cells.set_linewidth(0.2)
    axes.add_collection(cells)
    lower, upper = data["corners"].values
    axes.set_xlim(lower[0], upper[0])
    axes.set_ylim(lower[1], upper[1])
    axes.set_aspect("equal")
    for spine in axes.spines.values():
        spine.set_visible(True)
    return cells


def outline(axes, data, shape, color="white"):
    """Draw the outline of a set of cells."""
    cells = data["cells"].values
    sides = cells[:, [[0, 1], [1, 2], [2, 3], [3, 0]]].reshape(-1, 2)
    owner = np.repeat(np.asarray(shape, bool), 4)
    _, inverse = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    inverse = inverse.ravel()
    inside, total = np.bincount(inverse, owner), np.bincount(inverse)
    border = ((inside == 1) & (total == 2))[inverse] & owner
    axes.add_collection(LineCollection(data["X"].values[sides[border]], colors=color, linewidths=0.9))


def curve_places(data) -> list[tuple[int, str, str]]:
    """(index of the location, name, colour) of the matrix, and of the inclusion where there is one."""
    there = np.isfinite(data["curve_location"].values).all(axis=1)
    known = enumerate(zip(("matrix", "inclusion"), (MATRIX, INCLUSION), strict=True))
    return [(index, name, colour) for index, (name, colour) in known if there[index]]


def inclusion_note(data) -> str | None:
    """That there is no inclusion and which would have been seen, above the curves; None where one may be drawn."""
    summary = json.loads(data.attrs["summary"])
    if summary.get("inclusion") != NONE:
        return None
    contrast = significant(100.0 * summary["detectable_contrast"])
    return f"no inclusion distinguishable;\ncontrasts above {contrast} %\nwould have been seen"


def mark_places(axes, data) -> None:
    """Mark the points of matrix and inclusion at which curves are drawn."""
    for index, _, colour in curve_places(data):
        axes.plot(*data["curve_location"].values[index], "s", color=colour, mec="white", ms=5)


def shared_norm(*fields) -> Normalize:
    """One colour scale for several fields."""
    low = min(float(np.nanmin(f)) for f in fields)
    high = max(float(np.nanmax(f)) for f in fields)
    return Normalize(low, high if high > low else low + 1.0)


def colour_bar(figure, axes, mappable, label: str, values=None, **place):
    """A slim labelled colour bar, pointed at an end beyond which there are values, of several fields where given."""
    values, norm = mappable.get_array() if values is None else values, mappable.norm
    below, above = values.min() < norm.vmin, values.max() > norm.vmax
    extend = {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}
    place = place or {"fraction": 0.046, "pad": 0.03}
    bar = figure.colorbar(mappable, ax=axes, extend=extend[bool(below), bool(above)], **place)
    bar.set_label(label)
    bar.outline.set_visible(False)
    return bar


def unit_label(unit: str) -> str:
    """A unit in brackets, a dash for a pure number."""
    return f" [{'-' if unit in ('1', '') else unit}]"


def force_label(units: dict[str, str]) -> str:
    """The unit of a force in brackets; that of a sheet without units of length is a stress times its area."""
    return f" [{units['force']} × unit area]" if units["length"] == "1" else unit_label(units["force"])


def is_biaxial(kind: str) -> bool:
    """Whether a kind of load is judged under equibiaxial stretch rather than uniaxial stress."""
    return tensile_axis(kind) is None


def indicator_label(kind: str, units: dict[str, str]) -> str:
    """The stress that stands for a material: the trace under biaxial loads, the axial one otherwise."""
    name = {None: "tr $P$", 0: "$P_{xX}$", 1: "$P_{yY}$"}[tensile_axis(kind)]
    return name + unit_label(units["stress"])


def interpolated(field) -> bool:
    """Whether the deformation gradient of an opened file is that of an interpolant."""
    return "F_interpolated" in field


def from_zero(axes) -> None:
    """Let an axis of forces begin at zero unless some are negative."""
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]) if axes.dataLim.y0 < 0 else 0.0)


def save(figure, files: dict[str, str], provenance: dict, parents) -> None:
    """Write a figure in several formats."""
    for kind, path in files.items():
        with plt.rc_context(RC):
            write_bytes_atomically(
                path,
                lambda temporary, kind=kind: figure.savefig(temporary, format=kind, metadata=METADATA[kind]),
                provenance,
                parents,
            )
    plt.close(figure)
