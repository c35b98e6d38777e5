"""One look for every figure: fonts, colours, field maps, saving."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize

from hypernode.storage.netcdf import write_bytes_atomically

#: Okabe-Ito colours, told apart with any colour vision.
MATRIX, INCLUSION, NEUTRAL = "#0072B2", "#D55E00", "#444444"
FIELD_MAP, STRAIN_MAP, ERROR_MAP, ANGLE_MAP = "viridis", "cividis", "magma", "twilight"
RC = {
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "legend.fontsize": 7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "pdf.fonttype": 42,
    "svg.hashsalt": "hypernode",
    "figure.dpi": 150,
    "savefig.dpi": 300,
}


def draw_field(axes, dataset, values, norm: Normalize, cmap: str = FIELD_MAP):
    """Draw one value a cell in the reference configuration; returns the mappable for a colour bar."""
    corners = dataset["X"].values[dataset["cells"].values]
    cells = PolyCollection(corners, array=np.ma.asarray(values), cmap=cmap, norm=norm, rasterized=True)
    cells.set_edgecolor("face")
    cells.set_linewidth(0.2)
    axes.add_collection(cells)
    lower, upper = dataset["corners"].values
    axes.set_xlim(lower[0], upper[0])
    axes.set_ylim(lower[1], upper[1])
    axes.set_aspect("equal")
    for spine in axes.spines.values():
        spine.set_visible(True)
    return cells


def outline(axes, dataset, shape, color="white"):
    """Draw the outline of a set of cells."""
    cells = dataset["cells"].values
    sides = cells[:, [[0, 1], [1, 2], [2, 3], [3, 0]]].reshape(-1, 2)
    owner = np.repeat(np.asarray(shape, bool), 4)
    _, inverse = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    inverse = inverse.ravel()
    inside, total = np.bincount(inverse, owner), np.bincount(inverse)
    border = ((inside == 1) & (total == 2))[inverse] & owner
    lines = dataset["X"].values[sides[border]]
    axes.add_collection(matplotlib.collections.LineCollection(lines, colors=color, linewidths=0.9))


def shared_norm(*fields) -> Normalize:
    """One colour scale for several fields."""
    low = min(float(np.nanmin(f)) for f in fields)
    high = max(float(np.nanmax(f)) for f in fields)
    return Normalize(low, high if high > low else low + 1.0)


def colour_bar(figure, axes, mappable, label):
    """A slim labelled colour bar beside one panel or several."""
    bar = figure.colorbar(mappable, ax=axes, fraction=0.046, pad=0.03)
    bar.set_label(label)
    bar.outline.set_visible(False)


def unit_label(text: str) -> str:
    """A unit in brackets, nothing for a pure number."""
    return "" if text in ("1", "") else f" [{text}]"


def save(figure, files: dict[str, str], provenance: dict, parents) -> None:
    """Write a figure in several formats, without dates, so that the same figure is the same file."""
    metadata = {
        "pdf": {"CreationDate": None, "Producer": None, "Creator": "hypernode"},
        "png": {"Software": "hypernode"},
    }
    for kind, path in files.items():
        write_bytes_atomically(
            path,
            lambda temporary, kind=kind: figure.savefig(temporary, format=kind, metadata=metadata[kind]),
            provenance,
            parents,
        )
    plt.close(figure)
