"""A real test: frames on one grid and a force record, as the measurement that an identification starts from."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hypernode.config.specimens import Specimen
from hypernode.dic.errors import DicError
from hypernode.dic.force_record import read_force_record
from hypernode.dic.reading import read_specimen
from hypernode.dic.series import Series
from hypernode.fem.gradient import deformation_gradient
from hypernode.fem.mesh import EDGE_NAMES, Mesh, rectilinear
from hypernode.mechanics.loads import CONSTRAINED
from hypernode.mechanics.relaxation import ELASTIC, Relaxation, fit_relaxation
from hypernode.progress import say

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


def _relaxation(specimen: Specimen, used: Series, record) -> Relaxation:
    """What of the force record is a matter of time, from the stretch of the reference and of the frames used.

    Frames that are not used, and the record after the last one that is, stay unseen: they may serve as a test.
    """
    if not specimen.relaxation:
        return ELASTIC
    stretch = _mean_stretch(used, _AXIS[specimen.load])
    known = np.isfinite(stretch) & (stretch > 0.0)
    observed = _frame_times(specimen, used, np.array([frame.number for frame in used.frames]))[known]
    time, force = record
    during = (time >= observed[0]) & (time <= observed[-1])
    if known.sum() <= _FRAMES_FOR_RELAXATION or during.sum() < _SAMPLES_FOR_RELAXATION:
        why = (
            f"{known.sum()} frames and {during.sum()} samples of the force record are too few to tell relaxation "
            f"from elasticity (more than {_FRAMES_FOR_RELAXATION} and at least {_SAMPLES_FOR_RELAXATION}): "
            "the sheet counts as elastic"
        )
        say("import", specimen.folder, why)
        return ELASTIC
    return fit_relaxation(time[during], np.interp(time[during], observed, stretch[known]), force[during])


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


@dataclass(frozen=True)
class ImportedTest:
    """A real test on the mesh of its points, in mm, N and s, y upward.

    Attributes:
        mesh: cells between points that are measured in every frame used.
        numbers: of the frames used.
        time: of each since the start of the record (step,).
        u: displacement since the reference (step, node, 2).
        H: mean displacement gradient (step, 2, 2).
        axis: along which the sheet is pulled.
        edge_force, constrained: resultant and whether the displacement is prescribed, by step, edge and component.
        relaxation: what of the force is a matter of time.
        field: corners of the whole measured field (2, 2), before the outermost points were dropped.
        lost_points: how many points of the grid are lost in a frame used.
        files: every file that was read.
    """

    mesh: Mesh
    numbers: np.ndarray
    time: np.ndarray
    u: np.ndarray
    H: np.ndarray
    axis: int
    edge_force: np.ndarray
    constrained: np.ndarray
    relaxation: Relaxation
    field: np.ndarray
    lost_points: int
    files: tuple[Path, ...]


def import_test(specimen: Specimen) -> ImportedTest:
    """Read a specimen's frames and force record, the force interpolated at each frame's time.

    Raises:
        DicError: any input that cannot be used, with file and line.
    """
    folder = Path(specimen.folder)
    full = read_specimen(specimen)
    mm = full.millimetres(specimen.pixel_size)
    series = _trimmed(full, specimen.edge_ring)
    numbers = _select(specimen, series)
    force_path = folder / specimen.force_file
    record_time, record_force = read_force_record(force_path)
    record = record_time, record_force - specimen.force_offset
    time = _frame_times(specimen, series, numbers)
    force = _force_at(time, numbers, record, force_path)
    used = Series(series.x, series.y, [series.frames[0]] + [f for f in series.frames if f.number in numbers])
    mesh, u = _measured(folder, series, used, numbers, mm)
    edge_force, constrained = _edges(specimen, mesh, force)
    return ImportedTest(
        mesh,
        numbers,
        time,
        u,
        _mean_H(folder, mesh, u, numbers),
        _AXIS[specimen.load],
        edge_force,
        constrained,
        _relaxation(specimen, used, record),
        np.array([[0.0, 0.0], [full.x[-1] * mm, full.y[-1] * mm]]),
        int(used.lost.sum()),
        (force_path, *full.files),
    )


def _measured(folder: Path, series: Series, used: Series, numbers, mm: float):
    """(mesh of the points that no frame used has lost, their displacement since the reference)."""
    valid = ~used.lost
    keep = valid[:-1, :-1] & valid[1:, :-1] & valid[:-1, 1:] & valid[1:, 1:]
    if not keep.any():
        raise DicError(f"{folder}: no four neighbouring points are measured in all of the frames {numbers.tolist()}")
    mesh = rectilinear(series.x * mm, series.y * mm, keep)
    grid = np.stack(np.meshgrid(series.x * mm, series.y * mm), axis=-1).reshape(-1, 2)
    place = _places(grid, mesh.nodes)
    by_number = {f.number: f.displacement for f in series.frames}
    u = np.stack([by_number[n].reshape(-1, 2)[place] * mm for n in numbers])
    reference = by_number[series.frames[0].number].reshape(-1, 2)[place] * mm
    return mesh, u - np.nan_to_num(reference)


def _mean_H(folder: Path, mesh: Mesh, u, numbers) -> np.ndarray:
    """Mean displacement gradient of every step, where no frame folds the sheet over."""
    F = deformation_gradient(mesh, u)
    folded = (np.linalg.det(F) <= 0).any(axis=1)
    if folded.any():
        raise DicError(
            f"{folder}: frame {numbers[int(np.argmax(folded))]} folds the sheet over (det F is not positive): "
            "leave it out, or export it again"
        )
    return np.einsum("scij,c->sij", F, mesh.areas / mesh.areas.sum()) - np.eye(2)


def _places(grid, nodes):
    """Index of each mesh node in the full grid; both hold the same floating-point coordinates."""
    order = {tuple(point): index for index, point in enumerate(map(tuple, grid))}
    return np.array([order[tuple(node)] for node in nodes])
