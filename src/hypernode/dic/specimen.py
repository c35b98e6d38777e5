"""A real test: frames on one grid and a force record, as the measurement that an identification starts from."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hypernode.config.specimens import Specimen
from hypernode.data.lost import along, filled
from hypernode.dic.davis import Series, frame_files, read_series
from hypernode.dic.errors import DicError
from hypernode.dic.force_import import import_forces
from hypernode.dic.force_matching import PullRecord
from hypernode.fem.gradient import deformation_gradient
from hypernode.fem.mesh import EDGE_NAMES, Mesh, rectilinear
from hypernode.mechanics.loads import CONSTRAINED
from hypernode.mechanics.relaxation import ELASTIC, Relaxation, fit_relaxation
from hypernode.progress import say

#: The tensile axis of each load that a specimen may have.
_AXIS = {"clamped_x": 0, "clamped_y": 1}
#: Fewest deformed frames from which the course of the stretch is known well enough to tell time from elasticity.
_FRAMES_FOR_RELAXATION = 4
#: Share of a frame's points that may be lost: beyond it, more is guessed than measured.
MOST_LOST = 0.5
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


def _relaxation(specimen: Specimen, series: Series, used: Series, pull: PullRecord) -> Relaxation:
    """What of the force record is a matter of time, from the stretch of the reference and of the frames used.

    Between them, and beyond the last until the last picture, the crosshead tells how the stretch goes on, where the
    record has it. The displacements of frames that are not used stay unseen: they may serve as a test.
    """
    if not specimen.relaxation:
        return ELASTIC
    stretch = _mean_stretch(used, _AXIS[specimen.load])
    known = np.isfinite(stretch) & (stretch > 0.0)
    observed = pull.times(np.array([frame.number for frame in used.frames]))[known]
    last = pull.times(np.array([max(frame.number for frame in series.frames)]))[0]
    time, course = _stretch_course(pull, observed, stretch[known], last)
    if known.sum() <= _FRAMES_FOR_RELAXATION or len(time) < _SAMPLES_FOR_RELAXATION:
        why = (
            f"{known.sum()} frames and {len(time)} samples of the force record are too few to tell relaxation "
            f"from elasticity (more than {_FRAMES_FOR_RELAXATION} and at least {_SAMPLES_FOR_RELAXATION}): "
            "the sheet counts as elastic"
        )
        say("import", specimen.folder, why)
        return ELASTIC
    return fit_relaxation(time, course, np.interp(time, pull.time, pull.force), observed[1:])


def _stretch_course(pull: PullRecord, observed, stretch, last: float):
    """(times of the record's samples, mean stretch there), from the times and stretches of the frames used.

    Args:
        last: time of the last picture, until which the crosshead is believed to pull the sheet.
    """
    time, moved = pull.time, None
    if pull.displacement is not None:
        moved = np.interp(observed, time, pull.displacement)
    if moved is not None and len(moved) > 1 and (np.diff(moved) > 0.0).all():
        during = time[(time >= observed[0]) & (time <= last)]
        return during, along(np.interp(during, time, pull.displacement), moved) @ stretch
    during = time[(time >= observed[0]) & (time <= observed[-1])]
    return during, np.interp(during, observed, stretch)


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
        mesh: cells between the points of the grid, but for a hole. A lost point is missing data, and no hole.
        numbers: of the frames used.
        time: of each since the start of the record (step,).
        u: displacement since the reference (step, node, 2), NaN where a point was lost.
        H: mean displacement gradient (step, 2, 2).
        axis: along which the sheet is pulled.
        edge_force, constrained: resultant and whether the displacement is prescribed, by step, edge and component.
        relaxation: what of the force is a matter of time.
        field: corners of the whole measured field (2, 2), before the outermost points were dropped.
        lost_points: how many points of the mesh are lost in a frame used.
        files: every file that was read.
        force_findings: sentences on what is strange about the forces.
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
    force_findings: tuple[str, ...]


def import_test(specimen: Specimen, hole: Callable | None = None) -> ImportedTest:
    """Read a specimen's frames and force record, each frame's force by its picture or its time.

    Args:
        hole: where there is no material: more than a half at positions (point, 2) in the unit square, which is
            stretched over the measured field.

    Raises:
        DicError: any input that cannot be used, with file and line.
    """
    folder, mm = Path(specimen.folder), specimen.pixel_size
    full = read_series(folder, specimen.frames)
    series = _trimmed(full, specimen.edge_ring)
    numbers = _select(specimen, series)
    axis = _AXIS[specimen.load]
    read = np.array([frame.number for frame in series.frames])
    forces = import_forces(specimen, axis, read, _mean_stretch(series, axis), numbers)
    used = Series(series.x, series.y, [series.frames[0]] + [f for f in series.frames if f.number in numbers])
    field = np.array([[0.0, 0.0], [full.x[-1] * mm, full.y[-1] * mm]])
    mesh, u = _measured(series, numbers, mm, field, hole)
    edge_force, constrained = _edges(specimen, mesh, forces.force)
    paths = frame_files(folder)
    return ImportedTest(
        mesh,
        numbers,
        forces.time,
        u,
        _mean_H(folder, mesh, u, numbers),
        axis,
        edge_force,
        constrained,
        _relaxation(specimen, series, used, forces.pull),
        field,
        int(np.isnan(u).any(axis=(0, 2)).sum()),
        (forces.pull.record.path, *(paths[frame.number] for frame in full.frames)),
        forces.findings,
    )


def _measured(series: Series, numbers, mm: float, field, hole: Callable | None):
    """(mesh of the points, their displacement since the reference, NaN where they were lost)."""
    x, y = series.x * mm, series.y * mm
    keep = None
    if hole is not None:
        centres = np.stack(np.meshgrid(0.5 * (x[1:] + x[:-1]), 0.5 * (y[1:] + y[:-1])), axis=-1).reshape(-1, 2)
        keep = hole((centres - field[0]) / (field[1] - field[0])) <= 0.5
        if not keep.any():
            raise DicError("the hole leaves no cell of the grid")
    mesh = rectilinear(x, y, keep)
    grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    place = _places(grid, mesh.nodes)
    by_number = {f.number: f.displacement for f in series.frames}
    u = np.stack([by_number[n].reshape(-1, 2)[place] * mm for n in numbers])
    reference = by_number[series.frames[0].number].reshape(-1, 2)[place] * mm
    return mesh, u - np.nan_to_num(reference)


def _mean_H(folder: Path, mesh: Mesh, u, numbers) -> np.ndarray:
    """Mean displacement gradient of every step, where no frame folds the sheet over."""
    for number, lost in zip(numbers, np.isnan(u).any(axis=2), strict=True):
        if lost.mean() > MOST_LOST:
            raise DicError(
                f"{folder}: frame {number} has lost {lost.sum()} of {len(lost)} points, too many to tell what is "
                "between them: leave it out, or export it again"
            )
    F = deformation_gradient(mesh, filled(mesh, u))
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
