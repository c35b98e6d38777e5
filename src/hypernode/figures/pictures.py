"""What a camera saw of a sheet, and what image correlation read from its pictures."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Rectangle

from hypernode.data.measurement import measured_displacement, mesh_of
from hypernode.figures.style import (
    ERROR_MAP,
    FIELD_MAP,
    INCLUSION,
    SECOND,
    STRAIN_MAP,
    colour_bar,
    draw_field,
    shared_norm,
    unit_label,
)
from hypernode.storage.netcdf import units_of

#: Side of the close view over that of a subset or an element.
_CLOSE = 4.0
#: Share of values beyond the ends of a colour scale: some points at interfaces and edges would leave it to themselves.
_ENDS = (1.0, 99.0)


def draw(data, settings: dict):
    """The sheet at rest with its points, a subset, a deformed picture; correlation, displacement, and its error.

    Args:
        data: ``pictures``, ``correlated`` and ``measurement``: opened files.
        settings: ``step`` is the load step drawn.
    """
    pictures, correlated, measurement = (data[key] for key in ("pictures", "correlated", "measurement"))
    steps = measurement.sizes["load_step"]
    step = settings["step"] % steps
    figure, axes = plt.subplots(2, 3, figsize=(7.2, 4.2), layout="constrained")
    _reference(axes[0, 0], pictures, correlated, measurement, step)
    if "grey_X" in correlated:
        _square(axes[0, 1], pictures, int(correlated.attrs["correlation_step"]), "an element")
    else:
        _square(axes[0, 1], pictures, int(correlated.attrs["subset"]), "a subset")
    stretch = float(measurement["stretch"].values[step])
    _picture(axes[0, 2], pictures, step + 1)
    axes[0, 2].set_title(f"(c) at a stretch of {stretch:.4g}", loc="left")
    _correlation(figure, axes[1, 0], correlated, step)
    u = measured_displacement(measurement)[step]
    _field(figure, axes[1, 1], measurement, u, FIELD_MAP, "(e) displacement", "$|u|$", units_of(measurement)["length"])
    pixel = float(pictures.attrs["mm_per_pixel"])
    error = (u - measurement["u_truth"].values[step]) / pixel
    _field(figure, axes[1, 2], measurement, error, ERROR_MAP, "(f) its error", "$|u - u_\\mathrm{true}|$", "pixel")
    return figure


def _picture(axes, pictures, frame: int) -> None:
    axes.imshow(pictures["picture"].values[frame], cmap="gray", vmin=0, vmax=255, interpolation="none")
    axes.set_xlabel("column [pixel]")
    axes.set_ylabel("row [pixel]")


def _used(correlated, measurement):
    """Which points are on the measured grid: those with their whole subset on the sheet."""
    origin = np.array([correlated.attrs["origin_column"], correlated.attrs["origin_row"]])
    upward = np.array([1.0, -1.0]) * float(correlated.attrs["mm_per_pixel"])
    position = (np.stack([correlated["pixel_column"].values, correlated["pixel_row"].values], axis=1) - origin) * upward
    near = 0.5 * correlated.attrs["correlation_step"] * abs(upward[0])
    mesh = mesh_of(measurement)
    return ((position >= mesh.lower - near) & (position <= mesh.upper + near)).all(axis=1)


def _reference(axes, pictures, correlated, measurement, step: int) -> None:
    """The sheet at rest, the points of the measured grid, and which of all points are lost in the load step."""
    _picture(axes, pictures, 0)
    used = _used(correlated, measurement)
    column, row = correlated["pixel_column"].values, correlated["pixel_row"].values
    axes.plot(column[used], row[used], ".", color=SECOND, markersize=0.8)
    lost = np.isnan(correlated["correlation"].values[step + 1])
    axes.plot(column[lost], row[lost], "x", color=INCLUSION, markersize=3, markeredgewidth=0.7)
    axes.set_title(f"(a) {used.sum()} points, {lost.sum()} lost", loc="left")


def _square(axes, pictures, side: int, what: str) -> None:
    """A close view of the middle of the sheet at rest with one subset or finite element."""
    row, column = (places.mean().round() for places in np.nonzero(pictures["on_sheet"].values))
    _picture(axes, pictures, 0)
    half = 0.5 * _CLOSE * side
    axes.set_xlim(column - half, column + half)
    axes.set_ylim(row + half, row - half)
    corner = (column - 0.5 * side, row - 0.5 * side)
    axes.add_patch(Rectangle(corner, side, side, fill=False, edgecolor=INCLUSION, linewidth=1.2))
    axes.set_title(f"(b) {what} of {side} pixels", loc="left")


def _correlation(figure, axes, correlated, step: int) -> None:
    """How alike each subset and what it was found to be are."""
    values = correlated["correlation"].values[step + 1]
    column, row = correlated["pixel_column"].values, correlated["pixel_row"].values
    grid = np.full((len(np.unique(row)), len(np.unique(column))), np.nan)
    grid[np.searchsorted(np.unique(row), row), np.searchsorted(np.unique(column), column)] = values
    norm = shared_norm(np.nanpercentile(values, (_ENDS[0], 100.0)))
    half = 0.5 * correlated.attrs["correlation_step"]
    extent = (column.min() - half, column.max() + half, row.max() + half, row.min() - half)
    image = axes.imshow(grid, cmap=STRAIN_MAP, norm=norm, extent=extent, interpolation="none")
    axes.set_xlabel("column [pixel]")
    axes.set_ylabel("row [pixel]")
    axes.set_title("(d) correlation with (a)", loc="left")
    colour_bar(figure, axes, image, "ZNCC [-]", values[np.isfinite(values)])


def _field(figure, axes, measurement, u, colours: str, title: str, label: str, unit: str) -> None:
    """The length of a vector, mean over the nodes of each cell; cells at lost points are left empty."""
    size = np.linalg.norm(u, axis=1)[measurement["cells"].values].mean(axis=1)
    known = size[np.isfinite(size)]
    mappable = draw_field(
        axes, measurement, np.ma.masked_invalid(size), shared_norm(np.percentile(known, _ENDS)), colours
    )
    length = unit_label(units_of(measurement)["length"])
    axes.set_xlabel(f"$X${length}")
    axes.set_ylabel(f"$Y${length}")
    axes.set_title(title, loc="left")
    colour_bar(figure, axes, mappable, label + unit_label(unit), known)
