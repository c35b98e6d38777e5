"""Stage 2 for a real test: a folder of frames and a force record become a measurement file."""

from pathlib import Path

import numpy as np

from hypernode.config.specimens import Specimen
from hypernode.dic.davis import Series
from hypernode.dic.errors import DicError
from hypernode.fem.mesh import EDGE_NAMES, Mesh
from hypernode.mechanics.loads import CONSTRAINED
from hypernode.mechanics.relaxation import ELASTIC, Relaxation, fit_relaxation

#: The tensile axis of each load that a specimen may have.
_AXIS = {"clamped_x": 0, "clamped_y": 1}


#: Fewest deformed frames from which the course of the stretch is known well enough to tell time from elasticity.
_FRAMES_FOR_RELAXATION = 4


#: Fewest samples of the force record for the same.
_SAMPLES_FOR_RELAXATION = 20


def _trimmed(series: Series, ring: int) -> Series:
    """The series without the outermost rings of points."""
    if min(len(series.x), len(series.y)) <= 2 * ring + 2:
        raise DicError(f"edge_ring = {ring} leaves no grid of {len(series.x)} x {len(series.y)} points")
    cut = slice(ring, -ring or None)
    frames = [type(f)(f.number, f.displacement[cut, cut]) for f in series.frames]
    return Series(series.x[cut], series.y[cut], frames)


def _mean_stretch(series: Series, axis: int) -> np.ndarray:
    """Mean stretch along the tensile axis of every frame, between end lines; NaN where one of them is lost."""
    position = (series.x, series.y)[axis]
    means = []
    for frame in series.frames:
        u = frame.displacement[..., axis]
        ends = (u[:, 0], u[:, -1]) if axis == 0 else (u[0], u[-1])
        low, high = (end[np.isfinite(end)].mean() if np.isfinite(end).any() else np.nan for end in ends)
        means.append(1.0 + (high - low) / (position[-1] - position[0]))
    return np.array(means)


def _select(specimen: Specimen, series: Series) -> np.ndarray:
    """Numbers of the frames that become load steps."""
    if specimen.frames is not None:
        return np.array(specimen.frames)
    stretch = _mean_stretch(series, _AXIS[specimen.load])
    numbers = [frame.number for frame in series.frames]
    if specimen.stretches is None:
        return np.array([numbers[index] for index in _evenly_spaced(stretch, specimen)])
    largest = max(stretch[np.isfinite(stretch)], default=1.0)
    chosen = []
    for target in specimen.stretches:
        if target > largest:
            raise DicError(
                f"{specimen.folder}: no frame reaches the mean stretch {target:g}; the largest is {largest:.4g}"
            )
        chosen.append(numbers[int(np.nanargmin(np.abs(stretch - target)))])
    if len(set(chosen)) < len(chosen):
        raise DicError(
            f"{specimen.folder}: stretches {specimen.stretches} pick the frames {chosen}: spread them further apart"
        )
    return np.array(chosen)


def _evenly_spaced(stretch: np.ndarray, specimen: Specimen) -> list[int]:
    """Indices of the frames nearest to ``load_steps`` mean stretches in equal steps up to the largest, each once."""
    if not np.nanmax(stretch[1:], initial=1.0) > 1.0:
        raise DicError(f"{specimen.folder}: in no frame is the sheet longer than in the first: check load and frames")
    # What follows the largest stretch is not the loading of the test.
    loading = stretch[: int(np.nanargmax(stretch)) + 1]
    targets = np.linspace(1.0, loading[-1], specimen.load_steps + 1)[1:]
    nearest = {int(np.nanargmin(np.abs(loading - target))) for target in targets}
    return sorted(nearest - {0})


def _frame_times(specimen: Specimen, series: Series, numbers: np.ndarray) -> np.ndarray:
    """Time [s] of each frame in the clock of the force record."""
    return specimen.first_frame_time + (numbers - series.frames[0].number) / specimen.frame_rate


def _force_at(time: np.ndarray, numbers: np.ndarray, record, path: Path) -> np.ndarray:
    """Force [N] at the time of each chosen frame, interpolated in the record."""
    record_time, record_force = record
    late = time > record_time[-1]
    if late.any():
        raise DicError(
            f"{path}: ends at {record_time[-1]:g} s, before frame {numbers[late][0]} at "
            f"{time[late][0]:g} s: check frame_rate and first_frame_time"
        )
    if (time < record_time[0]).any():
        raise DicError(f"{path}: begins after the first chosen frame: check first_frame_time")
    return np.interp(time, record_time, record_force)


def _relaxation(specimen: Specimen, series: Series, record) -> Relaxation:
    """What of the force record is a matter of time, from the stretch of every frame that was read."""
    stretch = _mean_stretch(series, _AXIS[specimen.load])
    known = np.isfinite(stretch) & (stretch > 0.0)
    if not specimen.relaxation or known.sum() <= _FRAMES_FOR_RELAXATION:
        return ELASTIC
    seen = _frame_times(specimen, series, np.array([frame.number for frame in series.frames]))[known]
    time, force = record
    during = (time >= seen[0]) & (time <= seen[-1])
    if during.sum() < _SAMPLES_FOR_RELAXATION:
        return ELASTIC
    return fit_relaxation(time[during], np.interp(time[during], seen, stretch[known]), force[during])


def _edges(specimen: Specimen, mesh: Mesh, force: np.ndarray):
    """(resultant [N], whether the displacement is prescribed) of each step, edge and component.

    The load cell sees the whole width; the grid that is left after dropping the edge ring is
    narrower, so its resultant is the share of its width.
    """
    axis = _AXIS[specimen.load]
    across = 1 - axis
    share = min(float(mesh.size[across]) / (specimen.width, specimen.height)[across], 1.0)
    edge_force = np.full((len(force), len(EDGE_NAMES), 2), np.nan)
    constrained = np.zeros(edge_force.shape)
    for edge, component in CONSTRAINED[specimen.load]:
        constrained[:, EDGE_NAMES.index(edge), component] = 1.0
    low, high = (("left", "right"), ("bottom", "top"))[axis]
    edge_force[:, EDGE_NAMES.index(high), axis] = force * share
    edge_force[:, EDGE_NAMES.index(low), axis] = -force * share
    return edge_force, constrained


def _places(grid, nodes):
    """Index of each mesh node in the full grid; both hold the same floating-point coordinates."""
    order = {tuple(point): index for index, point in enumerate(map(tuple, grid))}
    return np.array([order[tuple(node)] for node in nodes])
