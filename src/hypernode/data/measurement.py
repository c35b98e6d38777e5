"""What a measurement says, read from its opened file."""

import json

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.fem.mesh import EDGES, Mesh


def mesh_of(dataset: xr.Dataset) -> Mesh:
    """The mesh that a file describes."""
    lower, upper = dataset["corners"].values
    return Mesh(dataset["X"].values, dataset["cells"].values, lower, upper)


def field_gradient(dataset: xr.Dataset) -> Float[np.ndarray, "2 2 step cell"]:
    """F[i, J, step, cell] at the cell centres, of an interpolant file or of a gradient file."""
    name = "F_interpolated" if "F_interpolated" in dataset else "F"
    return np.moveaxis(dataset[name].values, (2, 3), (0, 1))


def measured_displacement(measurement: xr.Dataset) -> Float[np.ndarray, "step node 2"]:
    """Mean over the repeats of the measured displacement, NaN where a point was lost in all of them."""
    u = measurement["u_measured"].values
    if not np.isnan(u).any():
        return u.mean(axis=0)
    known = np.isfinite(u)
    total = np.where(known, u, 0.0).sum(axis=0)
    return np.divide(total, known.sum(axis=0), out=np.full(total.shape, np.nan), where=known.any(axis=0))


def displacement_noise(measurement: xr.Dataset) -> float:
    """Level of independent errors of the mean over the repeats of the displacement, root mean square of all steps."""
    return float(np.sqrt(np.mean(noise_of_steps(measurement) ** 2)))


def noise_of_steps(measurement: xr.Dataset) -> Float[np.ndarray, "step 2"]:
    """The same of every step and component."""
    return measurement["noise_level"].values / np.sqrt(measurement.sizes["repeat"])


def scatter_of_steps(measurement: xr.Dataset) -> Float[np.ndarray, "step 2"]:
    """Standard deviation of the mean over the repeats of a measured displacement, of every step and component.

    Errors that points or steps share are smaller than the independent ones by which they are weighed.
    """
    return measurement["noise_scatter"].values / np.sqrt(measurement.sizes["repeat"])


def relaxation(measurement: xr.Dataset) -> Float[np.ndarray, "step 1 1"]:
    """Recorded over elastic force of each step, for the components of every edge."""
    return measurement["relaxation"].values[:, None, None]


def relaxation_at(measurement: xr.Dataset, time: Float[np.ndarray, " step"]) -> Float[np.ndarray, "step 1 1"]:
    """Recorded over elastic force at other times of a specimen's first test, for the components of every edge.

    Beyond the frames from which it is known, it is that of the nearest time.

    Args:
        time: in the clock of the force record [s].
    """
    factor = np.interp(time, measurement["relaxation_time"].values[0], measurement["relaxation_factor"].values[0])
    return (factor / json.loads(measurement.attrs["pace"])[0])[:, None, None]


def stress_resultants(measurement: xr.Dataset) -> Float[np.ndarray, "step edge 2"]:
    """Measured force over thickness of an elastic sheet, NaN where not measured."""
    return measurement["edge_force"].values / relaxation(measurement) / float(measurement.attrs["thickness"])


def mean_of_ends(force: Float[np.ndarray, "step edge 2"], axis: int, i: int) -> Float[np.ndarray, " step"]:
    """Pull in direction i on the sides normal to an axis: the mean of both readings of it, or the one that is known.

    The outward force at the upper side and minus that at the lower one are two readings. NaN where neither is known.
    """
    (lower, _), (upper, _) = (pair for pair in enumerate(EDGES.values()) if pair[1][0] == axis)
    both = np.stack([-force[:, lower, i], force[:, upper, i]])
    known = np.isfinite(both)
    total, count = np.where(known, both, 0.0).sum(axis=0), known.sum(axis=0)
    return np.divide(total, count, out=np.full(len(total), np.nan), where=count > 0)


def nodal_forces(measurement: xr.Dataset) -> Float[np.ndarray, "step node 2"] | None:
    """Outward force on every node over the thickness, or None where none is known, as of every load cell."""
    if "nodal_force" not in measurement:
        return None
    return measurement["nodal_force"].values / float(measurement.attrs["thickness"])


def relative_thickness(measurement: xr.Dataset) -> Float[np.ndarray, " cell"]:
    """Thickness of every cell over the thickness by which forces are divided."""
    return measurement["relative_thickness"].values


#: What of a record leaves the force of each step open, beside what is stated.
PAIRING_OPEN, RELAXATION_OPEN = "force_pairing_uncertainty", "force_relaxation_uncertainty"


def force_uncertainty(measurement: xr.Dataset) -> Float[np.ndarray, " step"]:
    """Relative uncertainty of the forces of every step: what is stated, and what pairing and relaxation leave open."""
    total = np.full(measurement.sizes["load_step"], float(measurement.attrs["force_uncertainty"]))
    for name in (PAIRING_OPEN, RELAXATION_OPEN):
        if name in measurement:
            total = np.hypot(total, measurement[name].values)
    return total


def force_gain_uncertainty(measurement: xr.Dataset) -> float:
    """Relative uncertainty of the gain of a load cell, which all forces of one of its channels share.

    None where no force was recorded: the assumed one is a convention.
    """
    return float(measurement.attrs["force_gain_uncertainty"]) if measurement.attrs["forces"] == "measured" else 0.0


def force_offset_uncertainty(measurement: xr.Dataset) -> float:
    """Uncertainty of the zero of a load cell over the largest force of a channel, which all of its forces share."""
    return float(measurement.attrs["force_offset_uncertainty"]) if measurement.attrs["forces"] == "measured" else 0.0


def noise_uncertainty(measurement: xr.Dataset) -> float:
    """Relative uncertainty of the level of noise itself."""
    return float(measurement.attrs["noise_uncertainty"])


def is_on_its_own_grid(measurement: xr.Dataset) -> bool:
    """Whether it is stated that displacements are those of finite elements on the measured grid: none cuts a cell."""
    return measurement.attrs["mesh"] == "measured_grid"


def plane_of(measurement: xr.Dataset) -> str:
    """What the faces of the sheet do: ``stress`` where they are free, ``strain`` where the thickness stays."""
    # Synthetic sheets are thin.
    return str(measurement.attrs.get("plane", "stress"))


def is_cut_out(measurement: xr.Dataset) -> bool:
    """Whether the grid is cut out of a larger sheet, so that its outline is no edge of the sheet."""
    return measurement.attrs["outline"] == "cut"


def correlation_window(measurement: xr.Dataset) -> tuple[float, str]:
    """(side of the window through which the camera sees, 0 without one; its kernel, ``average`` or ``quadratic``)."""
    # Files of measurements that are older than the second kernel name none.
    return float(measurement.attrs["correlation_window"]), str(measurement.attrs.get("correlation_kernel", "average"))


def window_uncertainty(measurement: xr.Dataset) -> float:
    """Standard deviation of what is seen through the window about the mean over it, over what that mean changes."""
    return float(measurement.attrs.get("window_uncertainty", 0.0))


def window_sought(measurement: xr.Dataset) -> bool:
    """Whether displacements were seen through a window whose side nobody stated."""
    return correlation_window(measurement)[0] == 0.0 and window_uncertainty(measurement) > 0.0
