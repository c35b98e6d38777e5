"""Which phase is where in the sheet that is predicted: from a picture, from another identification, or one phase."""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float, Int

from hypernode.fem.contour import ContourLines
from hypernode.fem.mesh import Mesh
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.lines import Lines
from hypernode.identification.partition import levels
from hypernode.prediction.errors import PredictionError
from hypernode.prediction.laws import phase_laws

#: Points of a picture that are looked at along a side of a cell.
LOOKS = 16


@dataclass(frozen=True)
class Layout:
    """Where phases are.

    Attributes:
        order: phase, numbered from the softest, of each material in the order in which they are laid (material,).
        distances: distance of every node from the line of each material but the first, positive in it (line, node).
    """

    order: Int[np.ndarray, " material"]
    distances: Float[np.ndarray, "line node"]

    def field(self, lines: Lines, phases: Float[np.ndarray, "phase parameter"]) -> Interfaces:
        """Materials and lines of a sheet whose phases have these parameters."""
        return Interfaces(lines, phases[self.order], self.distances)


def one_phase(mesh: Mesh) -> Layout:
    """A homogeneous sheet."""
    return Layout(np.array([0]), np.zeros((0, len(mesh.nodes))))


def of_picture(
    picture: Float[np.ndarray, "row column"], count: int, grid: ContourLines, corners: Float[np.ndarray, "2 2"]
) -> Layout:
    """Grey levels of a picture as phases: the darkest is the softest.

    Args:
        picture: grey levels, the first row at the top.
        count: of phases.
        grid: lines on the measured grid.
        corners: lower left and upper right corner of what the picture shows, in the unit of the sheet.

    Raises:
        PredictionError: the picture has fewer grey levels than there are phases, or shows one nowhere on the sheet.
    """
    mesh = grid.mesh
    if len(np.unique(picture)) < count:
        raise PredictionError(
            f"the picture has {len(np.unique(picture))} grey levels and there are laws of {count} phases: give one law "
            "for each grey level, the darkest first"
        )
    middle = np.sort(levels(picture.ravel().astype(float), count))
    phase = np.abs(picture[..., None] - middle).argmin(axis=-1)
    share = np.stack([_around_nodes(phase == k, mesh, corners) for k in range(count)])
    for k in np.flatnonzero((share > 0.5).sum(axis=1) == 0):
        raise PredictionError(
            f"grey level {middle[k]:.3g} of the picture is nowhere on the measured grid: give laws of the phases that "
            "are, or a picture whose phases are larger than a cell of the grid"
        )
    distances = [grid.distance(np.where(s == 0.5, 1e-6, s - 0.5)) for s in share[1:]]
    return Layout(np.arange(count), np.array(distances).reshape(count - 1, len(mesh.nodes)))


def _around_nodes(inside, mesh: Mesh, corners) -> Float[np.ndarray, " node"]:
    """Share of a set of pixels in the square of a cell's size around every node."""
    step = np.array([np.median(np.diff(line)) for line in mesh.lines])
    at = (np.arange(LOOKS) + 0.5) / LOOKS - 0.5
    around = np.stack(np.meshgrid(at, at), axis=-1).reshape(-1, 1, 2) * step
    place = (mesh.nodes + around - corners[0]) / (corners[1] - corners[0])
    size = np.array(inside.shape[::-1])
    # What lies beyond the picture is as its outermost pixels.
    column, row = np.moveaxis(np.clip((place * size).astype(int), 0, size - 1), -1, 0)
    return inside[inside.shape[0] - 1 - row, column].mean(axis=0)


def of_identification(file: xr.Dataset, source: str, count: int, mesh: Mesh) -> Layout:
    """Lines that another identification of the sheet found; only its labels and lines are used.

    Raises:
        PredictionError: it found no materials, another number of them, or is of another grid.
    """
    found = phase_laws(file, source)
    if len(found) != count:
        raise PredictionError(
            f"{source}: holds {len(found)} materials and there are laws of {count} phases: give one law for each, or "
            "the shape as a picture (--shape)"
        )
    if file["X"].shape != mesh.nodes.shape or not np.allclose(file["X"].values, mesh.nodes):
        raise PredictionError(f"{source}: is of another grid than the measurement: name the identification of this one")
    if "interface_distance" not in file:
        return one_phase(mesh)
    order = np.argsort([law.label for law in found])
    return Layout(order, file["interface_distance"].values)
