"""A folder of displacement files at one look: how the sheet moves, how it is pulled and what is used of it."""

from collections.abc import Iterable
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from jaxtyping import Float
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.ticker import MaxNLocator

from hypernode.figures.style import (
    FIELD_MAP,
    INCLUSION,
    MATRIX,
    METADATA,
    NEUTRAL,
    RC,
    SECOND,
    STRAIN_MAP,
    colour_bar,
    from_zero,
    unit_label,
)
from hypernode.inspection.view import FolderView, largest_strain

#: Colour and name of the courses of the mean stretch.
_COURSES = ((MATRIX, "along $x$"), (INCLUSION, "along $y$"), (SECOND, "1 + shear"))
#: Percentiles of a field between which its colours differ: single points may be far off.
_USUAL = (1.0, 99.0)
#: Length of a panel's longer side in points, and smallest and largest mark of a lost point.
_PANEL, _MARK = 110.0, (1.0, 4.0)
#: Marks of the frames that become load steps.
_CHOSEN = {"marker": "o", "ms": 5.5, "mfc": "none", "mew": 1.3, "lw": 0}


def draw(view: FolderView):
    """The figure: displacement, strain, force against stretch, and stretch against the number of the frame."""
    with plt.rc_context(RC):
        figure, axes = plt.subplots(2, 2, figsize=(7.2, 6.4), layout="constrained", height_ratios=(1.25, 1.0))
        size = np.linalg.norm(view.displacement, axis=2)
        cells = 0.25 * (size[1:, 1:] + size[1:, :-1] + size[:-1, 1:] + size[:-1, :-1])
        _field(figure, axes[0, 0], view, cells, FIELD_MAP, "$|u|$" + unit_label(view.unit))
        strain = largest_strain(view.x, view.y, view.displacement)
        _field(figure, axes[0, 1], view, strain, STRAIN_MAP, "max. principal strain [-]")
        _forces(axes[1, 0], view)
        _stretches(axes[1, 1], view)
        titles = (f"displacement of frame {view.frame}", f"strain of frame {view.frame}", "force", "course of the test")
        for letter, title, panel in zip("abcd", titles, axes.flat, strict=True):
            panel.set_title(f"({letter}) {title}", loc="left")
        figure.suptitle(view.title, fontsize=10)
    return figure


def write(view: FolderView, files: Iterable[Path]) -> None:
    """Draw a folder and write the figure in the format that the ending of each file names."""
    figure = draw(view)
    with plt.rc_context(RC):
        for file in files:
            kind = file.suffix[1:].lower()
            figure.savefig(file, format=kind, metadata=METADATA[kind])
    plt.close(figure)


def _field(
    figure, axes, view: FolderView, values: Float[np.ndarray, "cell_row cell_column"], colours: str, label: str
) -> None:
    """A field on the sheet at rest, with the outline of the points used, the same deformed, and lost points."""
    rest = np.stack(np.meshgrid(view.x, view.y), axis=-1)
    corners = np.stack([rest[:-1, :-1], rest[:-1, 1:], rest[1:, 1:], rest[1:, :-1]], axis=2)
    known = np.isfinite(values)
    if known.any():
        low, high = np.percentile(values[known], _USUAL)
        norm = Normalize(low, high if high > low else low + 1.0)
        shown = PolyCollection(corners[known], array=values[known], cmap=colours, norm=norm, rasterized=True)
        shown.set_edgecolor("face")
        shown.set_linewidth(0.2)
        axes.add_collection(shown)
        colour_bar(figure, axes, shown, label)
    axes.plot(*_around(rest, view.ring).T, color="black", lw=1.0, label="points used")
    axes.plot(*_around(rest + view.displacement, view.ring).T, "--", color=NEUTRAL, lw=0.9, label="the same, deformed")
    if view.missing.any():
        step = max(np.median(np.diff(view.x)), np.median(np.diff(view.y))) / np.ptp(rest, axis=(0, 1)).max()
        mark = float(np.clip(_PANEL * step, *_MARK))
        axes.plot(*rest[view.missing].T, "x", color=INCLUSION, ms=mark, mew=0.9, label="lost points")
    axes.set_aspect("equal")
    axes.margins(0.04)
    axes.set_xlabel("$x$" + unit_label(view.unit))
    axes.set_ylabel("$y$" + unit_label(view.unit))
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=3, columnspacing=1.0)


def _around(position: Float[np.ndarray, "row column 2"], ring: int) -> Float[np.ndarray, "point 2"]:
    """The outermost points of a grid without some rings, in their order around it."""
    kept = position[ring : position.shape[0] - ring, ring : position.shape[1] - ring]
    return np.concatenate([kept[0], kept[1:, -1], kept[-1, -2::-1], kept[-2::-1, 0]])


def _forces(axes, view: FolderView) -> None:
    """Force against stretch of every frame; marked are those that become load steps."""
    axes.set_xlabel("mean stretch [-]")
    axes.set_ylabel("force [N]")
    if not view.courses:
        axes.text(0.5, 0.5, "no force is known", transform=axes.transAxes, ha="center", color=NEUTRAL)
        return
    for course, colour in zip(view.courses, (MATRIX, INCLUSION), strict=False):
        i, J = ("xy"[k] for k in course.part)
        axes.plot(
            course.stretch, course.force, ".-", ms=3, lw=0.7, color=colour, label=f"along ${i}$, ends normal to ${J}$"
        )
        at = np.isin(course.numbers, view.chosen)
        axes.plot(course.stretch[at], course.force[at], color=colour, **_CHOSEN)
    axes.plot([], [], color="black", label="load steps", **_CHOSEN)
    from_zero(axes)
    axes.legend(loc="best")


def _stretches(axes, view: FolderView) -> None:
    """Stretch against the number of the frame, and how many points are lost where any are."""
    for course, (colour, name) in zip((*view.stretch[:, :2].T, 1.0 + view.stretch[:, 2]), _COURSES, strict=True):
        axes.plot(view.numbers, course, ".-", ms=3, lw=0.7, color=colour, label=name)
        at = np.isin(view.numbers, view.chosen)
        axes.plot(np.array(view.numbers)[at], course[at], color=colour, **_CHOSEN)
    axes.set_xlabel("number of the frame")
    axes.set_ylabel("mean stretch [-]")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.legend(loc="best")
    if view.lost.any():
        share = axes.twinx()
        share.fill_between(view.numbers, 100.0 * view.lost, step="mid", color=NEUTRAL, alpha=0.2, lw=0)
        share.set_ylabel("lost points [%]", color=NEUTRAL)
        share.set_ylim(0.0, max(5.0, 300.0 * view.lost.max()))
        share.spines["right"].set_visible(True)
