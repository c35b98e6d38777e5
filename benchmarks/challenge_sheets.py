"""Virtual sheets that are printed, pulled and written as those of the 2025 Mechanical MNIST Challenge were.

A camera sees a grid through an averaging window, or takes pictures of speckle whose points an engine follows.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float
from scipy.interpolate import CubicSpline

from hypernode.config.correlation import Correlation
from hypernode.config.pictures import Pictures, Speckle
from hypernode.dic.correlated import whole_subsets
from hypernode.fem.interpolation import NodalField
from hypernode.fem.mesh import Mesh, rectilinear
from hypernode.fem.solver import EquilibriumSolver, closed_form_stress
from hypernode.identification.camera import window_average
from hypernode.mechanics.loads import make_load
from hypernode.pictures.correlation import correlate
from hypernode.pictures.photograph import light, recorded, sheet_mask
from hypernode.pictures.speckle import Pattern, sprayed
from hypernode.pictures.view import view_of
from hypernode.stages.challenge import SIDE, THICKNESS
from hypernode.synthetic.forward import resultants

#: (label of the matrix, of the stroke) -> shear moduli [MPa], of a printer's elastomers.
PAIRS = {(8, 0): (0.20, 0.38), (9, 3): (0.23, 0.60), (8, 4): (0.20, 1.0), (9, 7): (0.23, 1.6)}
#: What a sheet is stiffer along the lines that the printer lays, at most, over Young's modulus across them, and what
#: these lines stiffen by when they are pulled (k2 of Gasser, Ogden and Holzapfel).
PRINTED, STIFFENS = 0.15, 1.0
#: Points along a side, finite elements from one to the next, window in steps, noise in steps, frames, largest stretch.
POINTS, FINER, WINDOW, NOISE, FRAMES, STRETCH = 27, 2, 1.5, 0.01, 9, 1.15
#: Share of the crosshead's travel that clamps take, and where a force falls when the sheet tears.
CLAMPS, TORN = 0.05, 0.6
#: Pixels from one point to the next: of the files of the challenge, and of pictures, which are smaller than its own.
STEP, PICTURE_STEP = 23.0, 15
#: Side of what an engine compares, as wide as the window, and how far it looks: beyond the travel of the upper end.
SUBSET, REACH = 23, 80


@dataclass(frozen=True, kw_only=True)
class Pulled:
    """A sheet of side one, in equilibrium.

    Attributes:
        mesh: of its finite elements.
        u: displacement (step, node, 2).
        stretch: along the pull (step,).
        force: on the upper end (step,) [N].
        curve, half: points of the stroke (point, 2), and half its width.
    """

    mesh: Mesh
    u: Float[np.ndarray, "step node 2"]
    stretch: Float[np.ndarray, " step"]
    force: Float[np.ndarray, " step"]
    curve: Float[np.ndarray, "point 2"]
    half: float


def stroke(random) -> np.ndarray:
    """Points of a pen's stroke in the unit square: a smooth curve through five places from the top down, as a digit."""
    x = 0.5 + 0.22 * random.uniform(-1.0, 1.0, 5)
    y = np.linspace(0.82, 0.18, 5) + random.uniform(-0.05, 0.05, 5)
    t = np.linspace(0.0, 4.0, 60)
    return np.stack([CubicSpline(np.arange(5), x)(t), CubicSpline(np.arange(5), y)(t)], axis=1)


def inside(X, curve, half: float):
    """Whether positions in the unit square lie within a half width of a curve."""
    return (np.linalg.norm(X[:, None] - curve[None], axis=2) < half).any(axis=1)


def printed(random, mu: Float[np.ndarray, " cell"]) -> dict[str, np.ndarray]:
    """Parameters of every cell of a sheet whose lines are laid along the pull or across it.

    A small stretch e along fibres of strength k1 gives them a stress of 4 k1 e, and the matrix one of 3 mu e.

    Args:
        mu: shear moduli of the matrix [MPa].
    """
    stiffer, along = random.uniform(0.0, PRINTED), random.choice([0.0, np.pi / 2])
    each = {"C10": mu / 2, "k1": 0.75 * stiffer * mu, "k2": STIFFENS, "kappa": 0.0, "fibre_angle": along}
    return {"model": np.zeros_like(mu), **{name: value * np.ones_like(mu) for name, value in each.items()}}


def pulled(random, pair: tuple[int, int]) -> Pulled:
    """A sheet with a stroke of its own, clamped at both ends."""
    curve, half = stroke(random), random.uniform(0.055, 0.08)
    line = np.linspace(0.0, 1.0, FINER * (POINTS - 1) + 1)
    mesh = rectilinear(line, line)
    mu = np.where(inside(mesh.centres, curve, half), PAIRS[pair][1], PAIRS[pair][0])
    solver = EquilibriumSolver(mesh, closed_form_stress(("goh",)), printed(random, mu))
    stretch = np.linspace(1.0, STRETCH, FRAMES)[1:]
    load = make_load("clamped_y", stretch)
    u, _ = solver.solve(load)
    force = np.array([resultants(solver, each, load)[3, 1] for each in u]) * SIDE * THICKNESS
    return Pulled(mesh=mesh, u=u, stretch=stretch, force=force, curve=curve, half=half)


def through_window(sheet: Pulled, random) -> tuple[np.ndarray, np.ndarray]:
    """(X, u) of a grid that a camera sees through its window, with noise, rows downward [pixel].

    Returns:
        Positions (row, column, 2) and displacements (frame, row, column, 2), y upward.
    """
    line = sheet.mesh.lines[0]
    seen = (window_average(sheet.mesh, WINDOW / (POINTS - 1)) @ sheet.u.reshape(len(sheet.u), -1).T).T
    seen = seen.reshape(len(sheet.u), len(line), len(line), 2)[:, ::FINER, ::FINER]
    pixels = STEP * (POINTS - 1)
    u = np.concatenate([np.zeros((1, POINTS, POINTS, 2)), seen]) * pixels
    u[1:] += STEP * NOISE * random.normal(size=u[1:].shape)
    return pixels * np.stack(np.meshgrid(line[::FINER], line[::FINER]), axis=-1), u


def through_pictures(sheet: Pulled, number: int, engine: str) -> tuple[np.ndarray, np.ndarray]:
    """(X, u) of points that an engine follows through pictures of the sheet, as :func:`through_window` gives them.

    Points whose subset reaches over the edge are left out. Lost ones are NaN.

    Args:
        number: seed of the speckle and of the camera's noise.

    Raises:
        EngineMissing: the engine is not installed.
        PictureError: it gave up.
    """
    pixels = PICTURE_STEP * POINTS
    settings = Pictures(pixels=pixels, seed=number, speckle=Speckle(seed=number))
    u = np.concatenate([np.zeros((1, *sheet.mesh.nodes.shape)), sheet.u])
    view = view_of(sheet.mesh.nodes + u, 1.0 / pixels, settings.margin)
    pattern = Pattern.of(sprayed((pixels, pixels), settings.speckle), (pixels, pixels))
    fields = [NodalField.of(sheet.mesh, each) for each in u]
    taken = [recorded(light(pattern, each, view, settings), settings, k) for k, each in enumerate(fields)]
    chosen = Correlation(engine=engine, subset=SUBSET, step=PICTURE_STEP, reach=REACH)
    found = correlate(np.stack(taken), sheet_mask(fields[0], view), chosen)
    X = (np.stack([found.column, found.row], axis=1) - (view.origin_column, view.origin_row)) * [1.0, -1.0]
    kept = whole_subsets(X, np.full(2, pixels), SUBSET)
    kept = np.flatnonzero(kept)[np.lexsort(X[kept].T)]
    shape = len(np.unique(X[kept, 1])), len(np.unique(X[kept, 0])), 2
    return X[kept].reshape(shape), (found.displacement[:, kept] * [1.0, -1.0]).reshape(-1, *shape)


def make(number: int, pair: tuple[int, int], label_upside_down: bool, path: Path, engine: str = "") -> None:
    """Write one test as the challenge writes them.

    Args:
        number: of the sheet, which is its seed.
        engine: what follows points through pictures; "" for a grid that is seen through a window.
    """
    random = np.random.default_rng([number, 25])
    sheet = pulled(random, pair)
    if engine:
        X, u = through_pictures(sheet, number, engine)
        pixels = PICTURE_STEP * POINTS
    else:
        X, u = through_window(sheet, random)
        pixels = STEP * (POINTS - 1)
    at = X.reshape(-1, 2) / pixels
    label = np.where(inside(at, sheet.curve, sheet.half), pair[1], pair[0]).reshape(X.shape[:2])
    # Rows of pictures run downward, and so do their displacements.
    X, u = X * [1.0, -1.0] + [0.0, pixels], u * [1.0, -1.0]
    crosshead = np.append(0.0, (sheet.stretch - 1.0) * SIDE / (1.0 - CLAMPS))
    force = np.append(0.0, sheet.force) + 0.003 * sheet.force.max() * random.normal(size=FRAMES)
    force[-1] *= TORN
    scale = crosshead[-1] / np.nanmax(np.abs(u[..., 1]))
    np.savez(
        path,
        DIC_X=X * scale,
        DIC_disp=u * scale,
        instron_disp=crosshead,
        instron_force=force,
        label=label[::-1] if label_upside_down else label,
    )
