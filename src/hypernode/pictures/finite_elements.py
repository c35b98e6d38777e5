"""Pictures compared with the first by finite elements: points, how well they are known, and what pictures say."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse
from jaxtyping import Bool, Float, UInt
from scipy.ndimage import binary_erosion

from hypernode.config.correlation import OUTLINE
from hypernode.data.information import Information, assembled
from hypernode.fem.factors import factorise
from hypernode.fem.mesh import Mesh
from hypernode.fem.refinement import refine
from hypernode.pictures.elements import Elements, Linearised, lattice
from hypernode.pictures.errors import PictureError
from hypernode.pictures.follower import Followed, Follower

#: Rows and columns of finer elements in one between points: what identification divides cells into.
DIVIDED = 2
#: Share of the mean information by which nodes are held together when pictures are sharp: of points next to nothing; of
#: the finer mesh, whose displacement is only where grey levels are linearised, enough to keep it from their noise.
_POINTS_HELD, _FINER_HELD = 1e-3, 0.1
#: Difference of grey levels over the typical one beyond which an element shows something else than the reference.
MISTAKEN = 3.0
#: Random vectors that estimate the mean variance of the points, to a few per cent.
_PROBES = 32


@dataclass(frozen=True, kw_only=True)
class Seen:
    """What pictures say of a sheet, in pixels, rows downward.

    Attributes:
        mesh: whose nodes are the points.
        u: their displacement in every picture after the first, NaN where one is lost.
        correlation: zero-normalised cross-correlation of the elements around each point, NaN where one is lost.
        noise: standard deviation of a point along columns and rows, root mean square of all points.
        level: that of as many independent points which would tell a shift of the sheet as well: less, since neighbours
            are wrong in opposite directions.
        grey_noise: standard deviation of each pixel, were all that is left of each picture noise.
        information: of all pictures after the first, on elements that are finer by :data:`DIVIDED`.
    """

    mesh: Mesh
    u: Float[np.ndarray, "picture point 2"]
    correlation: Float[np.ndarray, "picture point"]
    noise: Float[np.ndarray, "picture 2"]
    level: Float[np.ndarray, "picture 2"]
    grey_noise: Float[np.ndarray, " picture"]
    information: Information


def on_sheet(seen: Information, mm_per_pixel: float, origin: Float[np.ndarray, " 2"]) -> Information:
    """Information in pixels, rows downward, in the coordinates of the sheet, y upward.

    Args:
        mm_per_pixel: length of a pixel, in the unit of the sheet.
        origin: (column, row) of the point x = 0, y = 0.
    """
    upward = np.array([1.0, -1.0]) * mm_per_pixel
    # From the lower left corner counter-clockwise on, once y is upward.
    order = np.array([3, 2, 1, 0])
    dofs = (2 * order[:, None] + np.arange(2)).ravel()
    per_length = np.tile(1.0 / upward, 4)
    return Information(
        Mesh((seen.mesh.nodes - origin) * upward, seen.mesh.cells[:, order]),
        seen.u * upward,
        seen.matrix[..., dofs[:, None], dofs] * per_length[:, None] * per_length,
        seen.pull[..., dofs] * per_length,
    )


def seen_by_elements(
    pictures: UInt[np.ndarray, "picture row column"],
    mask: Bool[np.ndarray, "row column"],
    side: int,
    grey_noise: float | None = None,
) -> Seen:
    """Compare all pictures with the first, each from where the one before led.

    Differences of grey levels count by what their noise makes of them, and what is left beyond it.

    Args:
        mask: where the first picture shows the sheet.
        side: pixels between two points, even.
        grey_noise: standard deviation of each pixel of each picture, where it is known.

    Raises:
        PictureError: no element fits, or a picture is too unlike the first.
    """
    mesh = lattice(binary_erosion(mask, iterations=OUTLINE), side)
    if mesh is None or min(map(len, mesh.lines)) < 4:
        raise PictureError(
            f"less than three elements of {side} pixels fit into the mask along a side: take smaller ones"
        )
    finer = refine(mesh, DIVIDED)
    points = Follower(pictures[0], mesh, True, _POINTS_HELD)
    fine = Follower(pictures[0], finer.mesh, False, _FINER_HELD)
    u, before, found = np.zeros_like(mesh.nodes), np.zeros_like(mesh.nodes), []
    for number, picture in enumerate(pictures[1:], 1):
        # On as far as before, not on, or from rest where another test begins.
        each = points.follow(picture, points.likeliest(picture, (2.0 * u - before, u, np.zeros_like(u))))
        if not each.converged or not np.isfinite(each.u).all():
            raise PictureError(
                f"picture {number} after the first: no displacement of elements of {side} pixels was found that makes "
                "both alike: take larger elements (step), or more load steps"
            )
        before, u = u, each.u
        sharp = fine.follow(picture, finer.interpolation @ u)
        grey = _grey_noise(sharp, grey_noise)
        matrix, _ = points.elements.told(each.linear, grey)
        lost = _lost(points.elements, each.linear, matrix)
        seen = (~lost)[mesh.cells].all(axis=1)
        noise, level = _noise(mesh, matrix[seen], seen)
        fine_matrix, pull = fine.elements.told(sharp.linear, grey)
        unseen = finer.subcells[~seen]
        fine_matrix[unseen], pull[unseen] = 0.0, 0.0
        moved, alike = np.where(lost[:, None], np.nan, u), _correlation(points.elements, each.linear)
        alike[lost] = np.nan
        found.append((moved, alike, noise, level, sharp.noise, sharp.u, fine_matrix, pull))
    moved, alike, noise, level, grey, fine_u, matrix, pull = (np.stack(each) for each in zip(*found, strict=True))
    return Seen(
        mesh=mesh,
        u=moved,
        correlation=alike,
        noise=noise,
        level=level,
        grey_noise=grey,
        information=Information(finer.mesh, fine_u, matrix, pull),
    )


def _grey_noise(sharp: Followed, known: float | None) -> float:
    """Standard deviation of each pixel by which differences count, which the finer mesh leaves: a coarser one leaves
    some of the displacement too.

    Interpolation takes some of the noise away, but none of what is alike over several pixels, to which displacements
    answer. Beyond noise that is known, what is left counts as it is.
    """
    if known is None:
        return sharp.noise
    beyond = max(sharp.noise**2 - known**2, 0.0)
    return float(np.sqrt(known**2 + 0.5 * sharp.linear.noise_share * beyond))


def _lost(
    elements: Elements, linear: Linearised, matrix: Float[np.ndarray, "element 8 8"]
) -> Bool[np.ndarray, " node"]:
    """Points that a picture does not show: without texture, beyond its edge, or where it shows something else."""
    mesh = elements.mesh
    own, of_noise = np.zeros((len(mesh.nodes), 2, 2)), np.zeros(len(mesh.nodes))
    for corner in range(4):
        at = slice(2 * corner, 2 * corner + 2)
        np.add.at(own, mesh.cells[:, corner], matrix[:, at, at])
        np.add.at(of_noise, mesh.cells[:, corner], elements.noise_tells[corner])
    # Texture has less slope than the noise that hides it, in some direction.
    plain = np.linalg.eigvalsh(own)[:, 0] < of_noise
    each = np.sqrt(np.mean(linear.residual**2, axis=1))
    typical = np.median(each[linear.seen]) if linear.seen.any() else 0.0
    wrong = np.zeros(len(mesh.nodes), bool)
    wrong[mesh.cells[~linear.seen | (each > MISTAKEN * typical)]] = True
    return plain | wrong


def _correlation(elements: Elements, linear: Linearised) -> Float[np.ndarray, " node"]:
    """Zero-normalised cross-correlation of each element with what the picture shows of it, mean of those at a node."""
    before = elements.grey - elements.grey.mean(axis=1, keepdims=True)
    after = elements.grey - linear.residual
    after = after - after.mean(axis=1, keepdims=True)
    size = np.sqrt((before**2).sum(axis=1) * (after**2).sum(axis=1))
    alike = (before * after).sum(axis=1) / np.maximum(size, np.finfo(float).tiny)
    cells = elements.mesh.cells
    total = np.bincount(cells.ravel(), np.repeat(alike, 4), len(elements.mesh.nodes))
    return total / np.bincount(cells.ravel(), minlength=len(elements.mesh.nodes))


def _noise(mesh: Mesh, matrix: Float[np.ndarray, "seen 8 8"], seen: Bool[np.ndarray, " element"]):
    """(standard deviation of the points that are seen, that of independent ones), of each component.

    The first by the mean diagonal of the inverse of the information (Hutchinson's estimate), the second by its sum.
    """
    dofs = mesh.dofs[seen]
    K, _ = assembled(dofs, matrix, np.zeros((len(dofs), 8)), mesh.nodes.size)
    told = np.flatnonzero(K.diagonal() > 0.0)
    signs = np.random.default_rng(0).choice([-1.0, 1.0], (len(told), _PROBES))
    least = 1e-9 * K.diagonal().mean() * scipy.sparse.identity(len(told))
    diagonal = (signs * factorise((K[told][:, told] + least).tocsc()).solve(signs)).mean(axis=1)
    each = [told % 2 == i for i in (0, 1)]
    shifted = [(K[told[own]][:, told[own]].sum()) / own.sum() for own in each]
    return np.sqrt([diagonal[own].mean() for own in each]), 1.0 / np.sqrt(shifted)
