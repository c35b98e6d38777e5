"""A real sheet and its tests, as the measurement that an identification starts from."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from hypernode.config.specimens import Specimen
from hypernode.data.lost import filled
from hypernode.data.outliers import outliers
from hypernode.dic.errors import DicError
from hypernode.dic.forces.level import assumed_force
from hypernode.dic.load_case import LoadCase, import_load_case
from hypernode.dic.placing import on_one_grid
from hypernode.dic.relaxing import relaxations_of
from hypernode.dic.series import Series
from hypernode.dic.thickness import thickness_at
from hypernode.fem.gradient import deformation_gradient
from hypernode.fem.mesh import EDGE_NAMES, Mesh, rectilinear
from hypernode.mechanics.loads import CONSTRAINED, RESULTANTS
from hypernode.progress import say

#: Share of a frame's points that may be lost: beyond it, more is guessed than measured.
MOST_LOST = 0.5
#: How much larger the measured field may be than the sheet: half a correlation window at every side.
BEYOND = 0.05
#: Edges with the lower and the larger coordinate, by the axis of their normal.
_OPPOSITE = (("left", "right"), ("bottom", "top"))


@dataclass(frozen=True, kw_only=True)
class ImportedSpecimen:
    """The tests of a sheet on one mesh, in mm, N and s, y upward; steps of several tests follow one another.

    Attributes:
        mesh: cells between the points of the grid, but for a hole. A lost point is missing data, and no hole.
        cases: the tests as they were read.
        load_case: test of each step (step,).
        u: displacement since the reference, NaN where a point was lost.
        outliers: how many points of how many steps count as lost since they are off what their neighbours say.
        H: mean displacement gradient.
        edge_force: resultant of each edge that is known [N].
        constrained: 1 where the displacement is prescribed, by step, edge and component.
        field: corners of the first test's whole measured field.
        shares: of the sheet's sides that the grid covers, by test and axis.
        relative_thickness: of each cell, over that of the sheet.
        thickness_map: the file from which it is, where there is one.
    """

    mesh: Mesh
    cases: list[LoadCase]
    load_case: Int[np.ndarray, " step"]
    u: Float[np.ndarray, "step node 2"]
    outliers: int
    H: Float[np.ndarray, "step 2 2"]
    edge_force: Float[np.ndarray, "step edge 2"]
    constrained: Float[np.ndarray, "step edge 2"]
    field: Float[np.ndarray, "2 2"]
    shares: Float[np.ndarray, "case 2"]
    relative_thickness: Float[np.ndarray, " cell"]
    thickness_map: Path | None

    @property
    def stretch(self) -> Float[np.ndarray, " step"]:
        """Mean stretch of each step along its pull, or 1 + shear; of several directions the largest."""
        largest = []
        for k, case in enumerate(self.cases):
            H = self.H[self.load_case == k]
            parts = RESULTANTS[case.test.load]
            largest.append(np.max([H[:, i, J] if i == J else np.abs(H[:, i, J]) for i, J in parts], axis=0))
        return 1.0 + np.concatenate(largest)

    @property
    def forces_known(self) -> bool:
        """Whether any force was recorded."""
        return any(case.force for case in self.cases)

    @property
    def lost_points(self) -> int:
        """How many points of the mesh are lost in a frame used."""
        return int(np.isnan(self.u).any(axis=(0, 2)).sum())

    @property
    def files(self) -> list[Path]:
        """Every file that was read."""
        maps = (self.thickness_map,) if self.thickness_map else ()
        return list(dict.fromkeys((*(path for case in self.cases for path in case.files), *maps)))


def import_specimen(specimen: Specimen, hole: Callable | None = None, full: Series | None = None) -> ImportedSpecimen:
    """Read a specimen's tests onto one grid.

    Args:
        specimen: what the configuration says.
        hole: where there is no material: more than a half at positions (point, 2) in the unit square, which is
            stretched over the measured field.
        full: the frames of its one test, where they were read already.

    Raises:
        DicError: any input that cannot be used, with file and line.
    """
    cases = [import_load_case(specimen, test, full) for test in specimen.all_tests]
    told = relaxations_of(specimen.all_tests, [case.course for case in cases])
    cases = [replace(case, relaxation=each) for case, each in zip(cases, told, strict=True)]
    return specimen_of(specimen, cases, hole)


def specimen_of(specimen: Specimen, cases: list[LoadCase], hole: Callable | None = None) -> ImportedSpecimen:
    """A specimen's tests, once read, on one grid; see :func:`import_specimen`."""
    x, y, fields = on_one_grid(cases)
    field = np.stack([np.zeros(2), cases[0].size])
    mesh = _mesh(x, y, field, hole)
    u = [displacement.reshape(len(displacement), -1, 2)[:, mesh.places] for displacement in fields]
    mistaken = [_mistaken(case, mesh, each) for case, each in zip(cases, u, strict=True)]
    H = [_mean_H(case, mesh, each) for case, each in zip(cases, u, strict=True)]
    edge_force, constrained = (
        np.concatenate(each) for each in zip(*(_edges(specimen, case, mesh) for case in cases), strict=True)
    )
    if not any(case.force for case in cases):
        step, axis, force = assumed_force(np.concatenate(H), specimen.thickness * mesh.size[::-1])
        edge_force[step, 2 * axis : 2 * axis + 2, axis] = -force, force
    steps = [len(case.numbers) for case in cases]
    chart = Path(specimen.thickness_map) if specimen.thickness_map else None
    return ImportedSpecimen(
        mesh=mesh,
        cases=cases,
        load_case=np.repeat(np.arange(len(cases)), steps),
        u=np.concatenate(u),
        outliers=int(sum(each.sum() for each in mistaken)),
        H=np.concatenate(H),
        edge_force=edge_force,
        constrained=constrained,
        field=field,
        shares=np.tile(np.minimum(mesh.size / [specimen.width, specimen.height], 1.0), (len(cases), 1)),
        relative_thickness=thickness_at(chart, mesh.centres) / specimen.thickness
        if chart
        else np.ones(len(mesh.cells)),
        thickness_map=chart,
    )


def _mesh(x, y, field, hole: Callable | None) -> Mesh:
    keep = None
    if hole is not None:
        centres = np.stack(np.meshgrid(0.5 * (x[1:] + x[:-1]), 0.5 * (y[1:] + y[:-1])), axis=-1).reshape(-1, 2)
        keep = hole((centres - field[0]) / (field[1] - field[0])) <= 0.5
        if not keep.any():
            raise DicError("the hole leaves no cell of the grid")
    return rectilinear(x, y, keep)


def _mistaken(case: LoadCase, mesh: Mesh, u) -> np.ndarray:
    """Which points of which steps the software mistook; they are lost from ``u`` then, and said in the log."""
    found = outliers(mesh, u, case.noise.scatter)
    if found.any():
        u[found] = np.nan
        worst = int(np.argmax(found.sum(axis=1)))
        say(
            "import",
            case.test.folder,
            f"points off what their neighbours say count as lost: {found.sum()} in {len(u)} load steps, most "
            f"of them ({found[worst].sum()}) in frame {case.numbers[worst]}",
        )
    return found


def _mean_H(case: LoadCase, mesh: Mesh, u) -> np.ndarray:
    """Mean displacement gradient of every step of a test, where no frame folds the sheet over."""
    folder = case.test.folder
    for number, lost in zip(case.numbers, np.isnan(u).any(axis=2), strict=True):
        if lost.mean() > MOST_LOST:
            raise DicError(
                f"{folder}: frame {number} has lost {lost.sum()} of {len(lost)} points, too many to tell what is "
                "between them: leave it out, or export it again"
            )
    F = deformation_gradient(mesh, filled(mesh, u))
    folded = np.linalg.det(F) <= 0
    if folded.any():
        step = int(np.argmax(folded.any(axis=1)))
        x, y = mesh.centres[folded[step]][0]
        raise DicError(
            f"{folder}: frame {case.numbers[step]} folds the sheet over (det F is not positive in {folded[step].sum()} "
            f"of {len(mesh.cells)} cells, the first at {x:.4g}, {y:.4g} mm from the lower left point): a point that "
            "the software mistook, which may be deleted from the file and is then lost, or which a column tells "
            "(valid); displacements in another unit than positions (displacement_factor); or leave the frame out"
        )
    return np.einsum("scij,c->sij", F, mesh.areas / mesh.areas.sum()) - np.eye(2)


def _edges(specimen: Specimen, case: LoadCase, mesh: Mesh):
    """(resultant [N], whether the displacement is prescribed) of each step, edge and component.

    The load cell sees the whole section, and the grid is narrower. What is said to be its resultant is the share of its
    width, as in a uniform sheet; :mod:`hypernode.data.seen_share` says what a heterogeneous one makes of it.
    """
    edge_force = np.full((len(case.numbers), len(EDGE_NAMES), 2), np.nan)
    constrained = np.zeros(edge_force.shape)
    for edge, component in CONSTRAINED[case.test.load]:
        constrained[:, EDGE_NAMES.index(edge), component] = 1.0
    for (i, J), force in case.force.items():
        share = _share(specimen, case, mesh, 1 - J)
        low, high = (EDGE_NAMES.index(edge) for edge in _OPPOSITE[J])
        edge_force[:, high, i], edge_force[:, low, i] = force * share, -force * share
    return edge_force, constrained


def _share(specimen: Specimen, case: LoadCase, mesh: Mesh, along: int) -> float:
    """Share of the sheet's side along an axis that the grid covers."""
    name, side, field = ("width", "height")[along], (specimen.width, specimen.height)[along], float(mesh.size[along])
    if field > (1.0 + BEYOND) * side:
        raise DicError(
            f"{case.test.folder}: the measured points span {field:.4g} mm along {'xy'[along]}, beyond the {name} of "
            f"the sheet, {side:.4g} mm, which carries the force: check {name}, pixel_size and the unit of the files"
        )
    return min(field / side, 1.0)
