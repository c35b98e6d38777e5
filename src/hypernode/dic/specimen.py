"""A real test: frames on one grid and a force record, as the measurement that an identification starts from."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hypernode.config.specimens import Specimen
from hypernode.data.lost import filled
from hypernode.dic.errors import DicError
from hypernode.dic.force_import import import_forces
from hypernode.dic.frames import AXIS, mean_stretch, select_frames, trimmed
from hypernode.dic.reading import read_specimen
from hypernode.dic.relaxing import relaxation_of
from hypernode.dic.series import Series
from hypernode.fem.gradient import deformation_gradient
from hypernode.fem.mesh import EDGE_NAMES, Mesh, rectilinear
from hypernode.mechanics.loads import CONSTRAINED
from hypernode.mechanics.relaxation import Relaxation

#: Share of a frame's points that may be lost: beyond it, more is guessed than measured.
MOST_LOST = 0.5


def _edges(specimen: Specimen, mesh: Mesh, force: np.ndarray):
    """(resultant [N], whether the displacement is prescribed) of each step, edge and component.

    The load cell sees the whole width; the grid that is left after dropping the edge ring is
    narrower, so its resultant is the share of its width.
    """
    axis = AXIS[specimen.load]
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
    folder = Path(specimen.folder)
    full = read_specimen(specimen)
    mm = full.millimetres(specimen.pixel_size)
    series = trimmed(full, specimen.edge_ring)
    numbers = select_frames(specimen, series)
    axis = AXIS[specimen.load]
    read = np.array([frame.number for frame in series.frames])
    forces = import_forces(specimen, axis, read, mean_stretch(series, axis), numbers)
    used = Series(series.x, series.y, [series.frames[0]] + [f for f in series.frames if f.number in numbers])
    field = np.array([[0.0, 0.0], [full.x[-1] * mm, full.y[-1] * mm]])
    mesh, u = _measured(series, numbers, mm, field, hole)
    edge_force, constrained = _edges(specimen, mesh, forces.force)
    return ImportedTest(
        mesh,
        numbers,
        forces.time,
        u,
        _mean_H(folder, mesh, u, numbers),
        axis,
        edge_force,
        constrained,
        relaxation_of(specimen, series, used, forces.pull),
        field,
        int(np.isnan(u).any(axis=(0, 2)).sum()),
        (forces.pull.record.path, *full.files),
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
