"""Displacements of a test: prescribed and observed ones, and their noise."""

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse
from jaxtyping import Float, Int

from hypernode.data.believed_noise import BelievedNoise
from hypernode.data.believed_window import BelievedWindow
from hypernode.data.information import Information, information_of
from hypernode.data.loading import Loading
from hypernode.data.lost import filled
from hypernode.data.measurement import (
    correlation_window,
    displacement_noise,
    is_cut_out,
    is_on_its_own_grid,
    measured_displacement,
    mesh_of,
    noise_of_steps,
    noise_uncertainty,
    relative_thickness,
    scatter_of_steps,
)
from hypernode.fem.gradient import deformation_gradient
from hypernode.fem.mesh import EDGES, Mesh
from hypernode.fem.refinement import Refinement, refine
from hypernode.fem.transfer import transfer
from hypernode.identification import numerics, priors, thresholds
from hypernode.identification.boundary import Boundary, boundary_of
from hypernode.identification.camera import window_average
from hypernode.identification.window_error import (
    blurred_edges,
    window_errors,
    with_errors_of_elements,
)


@dataclass(frozen=True, kw_only=True)
class Observations:
    """A measurement as an identification uses it.

    Attributes:
        grid: the measured grid; ``refinement`` divides its cells into subcells.
        loading: what is known about the forces.
        u: mean of the repeats (step, node, 2), interpolated at lost points, which do not count as observed.
        sigma: root mean square standard deviation of u, from noise and discretisation together.
        expected: standard deviation of u over the error with which it weighs. It is 1 for independent errors, and less
            for shared errors, which weigh as larger independent ones.
        scatter: root mean square of ``expected``.
        noisy: whether noise dominates the discretisation error, or may equal it within their uncertainty.
        noise_uncertainty: relative uncertainty of that noise.
        believed_noise: the noise model in use.
        by_points: whether displacements of points were observed, and not grey levels of pictures.
        by_places: whether the error of each place is known: it is noise, or that of elements beside lines as well.
        own_grid: whether the displacements are those of finite elements on this very grid, so that no interface cuts
            a cell.
        window, kernel: side of the camera's correlation window, 0 without one, and its kernel.
        believed_window: that window if an identification estimated it; None if the measurement states it.
        cut: whether the grid is cut out of a larger sheet.
        largest_stretch: of the test.
        relative_thickness: of every subcell.
        boundaries: of every load step.
    """

    grid: Mesh
    refinement: Refinement
    loading: Loading
    u: Float[np.ndarray, "step node 2"]
    sigma: float
    expected: Float[np.ndarray, "step node 2"]
    scatter: float
    noisy: bool
    noise_uncertainty: float
    believed_noise: BelievedNoise
    by_points: bool
    by_places: bool
    own_grid: bool
    window: float
    kernel: str
    believed_window: BelievedWindow | None
    cut: bool
    largest_stretch: float
    relative_thickness: Float[np.ndarray, " subcell"]
    boundaries: tuple[Boundary, ...]

    @property
    def mean_F(self) -> Float[np.ndarray, "2 2 step"]:
        """Mean deformation gradient of the sheet."""
        area = self.grid.areas / self.grid.areas.sum()
        return np.einsum("scij,c->ijs", deformation_gradient(self.grid, self.u), area)

    @property
    def noise_deformation(self) -> float:
        """Apparent deformation between neighbouring points due to errors of displacements, over the largest of the
        sheet.

        The gradient at the centre of a cell follows from its four corners. Independent errors of size s cause a
        gradient with the norm 2 s over the side of the cell.
        """
        largest = np.linalg.norm(self.mean_F - np.eye(2)[:, :, None], axis=(0, 1)).max()
        return float(2.0 * self.sigma * self.scatter / (self.grid.step * largest))

    def of_steps(self, steps: Int[np.ndarray, " kept"]) -> "Observations":
        """The observations of some load steps, with the uncertainty of the whole test."""
        boundaries = tuple(self.boundaries[step] for step in steps)
        of_points = {"u": self.u[steps], "expected": self.expected[steps]}
        return replace(self, loading=self.loading.of_steps(steps), boundaries=boundaries, **of_points)


def description_error(own_grid: bool, subcells: int, cells: int) -> float:
    """What finite elements miss of displacements, over the largest of them.

    Args:
        own_grid: whether the displacements were computed on the measured grid.
        subcells: rows and columns into which a cell is divided.
        cells: how many there are.
    """
    if own_grid:
        return priors.SAME_GRID_FLOOR
    return (priors.SUBCELLS_FLOOR if subcells > 1 else priors.CUT_CELLS_FLOOR) / cells**0.5


def observe(measurement, subcells: int, floor: float | None = None, at_lines: bool = False) -> Observations:
    """The observations of an opened measurement.

    Of a grid that is cut out of a larger sheet, the measured displacement prescribes the outline all round.

    Args:
        subcells: rows and columns into which every measured cell is divided.
        floor: error of the description by finite elements, where it is known from what they left of a misfit.
        at_lines: whether that error is where displacements bend, as beside lines, and not the same everywhere.
    """
    grid, measured = mesh_of(measurement), measured_displacement(measurement)
    refinement, u, noise = refine(grid, subcells), filled(grid, measured), displacement_noise(measurement)
    own_grid, information = is_on_its_own_grid(measurement), information_of(measurement)
    believed_noise = BelievedNoise.read(measurement.attrs)
    told, cut = own_grid or floor is not None, is_cut_out(measurement)
    if floor is None:
        floor = description_error(own_grid, subcells, len(grid.cells)) * np.abs(u).max()
    prescribed = (measurement["edge_constrained"].values > 0) | cut
    seen = seen_points(refinement, *correlation_window(measurement))
    levels, spread = noise_of_steps(measurement), scatter_of_steps(measurement)
    # Of undivided cells that interfaces cut the error is known to a factor alone. Pictures show it, and divided cells.
    noisy = bool(noise >= floor * (1.0 if told or subcells > 1 or information is not None else thresholds.NOISE_RULES))
    # What finite elements make of cut cells is no noise, and counts beside it only where it is told.
    beside = floor if told or not noisy else 0.0
    sigma = float(np.hypot(noise, beside))
    error, weighed = window_errors(measurement, grid, u, not believed_noise.shared_by_none)
    if at_lines:
        error, weighed = with_errors_of_elements(error, weighed, grid, u, beside)
        beside = priors.SAME_GRID_FLOOR * np.abs(u).max()
    believed = np.hypot(np.hypot(levels, beside)[:, None], weighed)
    # Neighbouring nodes of a mesh are wrong in opposite directions: along an edge they scatter by more than they weigh.
    noise_of_edges, blurred = levels if information is None else spread, blurred_edges(measurement, grid, u, levels)
    each = zip(measured, prescribed, noise_of_edges, blurred, believed / sigma, strict=True)
    boundaries = [boundary_of(refinement, grid, *step, seen) for step in each]
    expected = np.hypot(np.hypot(spread, beside)[:, None], error) / believed
    if information is not None:
        expected = np.ones_like(expected)
        boundaries = _by_grey_levels(boundaries, grid, refinement, prescribed, information, noise)
    return Observations(
        grid=grid,
        refinement=refinement,
        u=u,
        sigma=sigma,
        expected=expected,
        scatter=float(np.sqrt(np.mean(expected**2))),
        noisy=noisy,
        believed_noise=believed_noise,
        by_points=information is None,
        by_places=bool(information is None and noise > 0.0 and (noisy or at_lines)),
        own_grid=own_grid,
        cut=cut,
        relative_thickness=_thickness_of_subcells(refinement, relative_thickness(measurement)),
        boundaries=tuple(boundaries),
        **_stated(measurement),
    )


def _stated(measurement) -> dict:
    """What the measurement itself says, by names of :class:`Observations`."""
    window, kernel = correlation_window(measurement)
    return {
        "loading": Loading.of(measurement),
        "noise_uncertainty": noise_uncertainty(measurement),
        "window": window,
        "kernel": kernel,
        "believed_window": BelievedWindow.read(measurement.attrs),
        "largest_stretch": float(measurement["stretch"].values.max()),
    }


def seen_points(refinement: Refinement, width: float, kernel: str) -> scipy.sparse.csr_matrix:
    """Matrix from displacements of the mesh, flattened, to what is seen of the measured grid's through a window."""
    at_points = 2 * refinement.nodes[:, None] + np.arange(2)
    return window_average(refinement.mesh, width, kernel)[at_points.ravel()]


def _thickness_of_subcells(refinement: Refinement, thickness: Float[np.ndarray, " cell"]):
    """That of the cell of each (subcell,)."""
    each = np.empty(len(refinement.mesh.cells))
    each[refinement.subcells] = thickness[:, None]
    return each


def _by_grey_levels(
    boundaries: list[Boundary],
    grid: Mesh,
    refinement: Refinement,
    prescribed: Float[np.ndarray, "step edge 2"],
    information: Information,
    unit: float,
) -> list[Boundary]:
    """The same where pictures are observed, and no points.

    Elements at edges that prescribe the displacement are left out: they have told it already.

    Args:
        prescribed: which components of which edges are.
        unit: the displacement that counts as one, which the information weighs by itself.
    """
    onto, of_grid = (transfer(mesh, information.mesh).nodes for mesh in (refinement.mesh, grid))
    onto = scipy.sparse.kron(onto, scipy.sparse.identity(2), format="csr")
    changed = []
    for step, boundary in enumerate(boundaries):
        on = [grid.on_edge(edge) for edge, held in zip(EDGES, prescribed[step], strict=True) if held.any()]
        told = of_grid @ np.any([np.zeros(len(grid.nodes), bool), *on], axis=0) > numerics.ROUNDING
        root, seen, observed = information.root(step, ~told[information.mesh.cells].any(axis=1))
        changed.append(
            replace(boundary, observed=observed, observe=unit * (root @ onto), seen=unit * seen, relative=np.empty(0))
        )
    return changed
