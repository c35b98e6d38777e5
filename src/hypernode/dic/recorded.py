"""The tests of a measurement as cameras and a machine would have recorded them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.data.loading import load_kind
from hypernode.data.measurement import mean_of_ends, measured_displacement, mesh_of, relaxation
from hypernode.dic.errors import DicError
from hypernode.dic.series import Frame, Series

#: Load -> axes along which the force must be known, and those along which it is recorded where it is.
_AXES = {
    "clamped_x": ("x", ""),
    "uniaxial_x": ("x", ""),
    "clamped_y": ("y", ""),
    "uniaxial_y": ("y", ""),
    "biaxial": ("xy", ""),
    "shear": ("x", "y"),
    "general": ("", "xy"),
}


@dataclass(frozen=True)
class RecordedTest:
    """One test of a measurement, the reference first.

    Attributes:
        load: as a specimen's configuration names it.
        series: its frames, on all points of the grid; NaN where one was lost or there is no material.
        displacement, force: of the machine by axis, "x" or "y", in the units of the measurement; none where no force
            was recorded.
    """

    load: str
    series: Series
    displacement: dict[str, Float[np.ndarray, " frame"]]
    force: dict[str, Float[np.ndarray, " frame"]]


def recorded_tests(measurement: xr.Dataset, path: Path) -> list[RecordedTest]:
    """The tests of a measurement: means over its repeats, and the forces of an elastic sheet.

    Args:
        measurement: an opened file.
        path: of the file, for messages.

    Raises:
        DicError: a load step carries no known force.
    """
    mesh, u = mesh_of(measurement), measured_displacement(measurement)
    x, y = mesh.lines
    elastic = measurement["edge_force"].values / relaxation(measurement)
    unknown = measurement.attrs["forces"] == "assumed"
    cases = []
    for number in range(int(measurement["load_case"].max()) + 1):
        steps = np.flatnonzero(measurement["load_case"].values == number)
        frames = np.full((len(steps) + 1, len(y) * len(x), 2), np.nan)
        frames[0, mesh.places], frames[1:, mesh.places] = 0.0, u[steps]
        series = Series(x, y, [Frame(k, each.reshape(len(y), len(x), 2)) for k, each in enumerate(frames)], unit="mm")
        H = measurement["H"].values[steps]
        load = load_kind(measurement["edge_constrained"].values[steps[0]] > 0, H)
        required, further = ("", "") if unknown else _AXES[load]
        force = {}
        for axis in (*required, *further):
            along = mean_of_ends(elastic[steps], _normal(load, axis), "xy".index(axis))
            if np.isfinite(along).all():
                force[axis] = np.append(0.0, along)
            elif axis in required:
                step = steps[int(np.argmax(np.isnan(along)))]
                raise DicError(f"{path}: load step {step} carries no known force along {axis}")
        if not (force or unknown):
            raise DicError(f"{path}: no step of load case {number} carries a known force")
        cases.append(RecordedTest(load, series, {axis: _moved(H, mesh.size, load, axis) for axis in force}, force))
    return cases


def _moved(H: Float[np.ndarray, "step 2 2"], size: Float[np.ndarray, " 2"], load: str, axis: str):
    """How far the machine moved along an axis, the reference first."""
    normal = _normal(load, axis)
    return np.append(0.0, H[:, "xy".index(axis), normal] * size[normal])


def _normal(load: str, axis: str) -> int:
    """Axis between the ends that the machine moves."""
    return 1 if load == "shear" else "xy".index(axis)
