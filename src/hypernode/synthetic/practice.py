"""A sheet to practise with: what cameras and a testing machine would see of a disc in a softer square."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hypernode.fem.mesh import EDGE_NAMES, rectilinear
from hypernode.fem.solver import EquilibriumSolver, closed_form_stress
from hypernode.mechanics.loads import RESULTANTS, make_load
from hypernode.synthetic.forward import resultants
from hypernode.synthetic.geometry import ellipse

#: Side and thickness of the sheet [mm].
SIDE, THICKNESS = 20.0, 1.0
#: Shear moduli of the neo-Hookean sheet and of the disc in it [MPa].
MATRIX, INCLUSION = 0.2, 0.6
#: Centre and radius of the disc [mm]. It is beside the middle, so that a turned map is seen to be turned.
CENTRE, RADIUS = (8.0, 11.0), 5.0
#: Measured points along a side, and finite elements from one to the next: no real sheet knows the grid of the cameras.
POINTS, FINER = 41, 2
#: Edge stretch of the last frame, and frames after the reference. Frames are a second apart.
STRETCH, FRAMES = 1.2, 10


@dataclass(frozen=True)
class Practice:
    """A test of the sheet, the reference first.

    Attributes:
        lines: coordinates of the measured points along x and along y [mm].
        displacement: of the points [mm].
        moved, force: what the machine shows by axis, "x" or "y" [mm], [N].
    """

    lines: Float[np.ndarray, " points"]
    displacement: Float[np.ndarray, "frame row column 2"]
    moved: dict[str, Float[np.ndarray, " frame"]]
    force: dict[str, Float[np.ndarray, " frame"]]


def practice_test(kind: str, noise: float, seed: int = 0) -> Practice:
    """The test of a sheet under one kind of load, pulled evenly to :data:`STRETCH`.

    Args:
        kind: of load, but ``general``, which is none that a machine could be told.
        noise: standard deviation of a measured displacement [mm].
        seed: of the noise.

    Raises:
        ConvergenceError: the sheet finds no equilibrium.
    """
    stretches = np.linspace(1.0, STRETCH, FRAMES + 1)[1:]
    load = make_load(kind, [(s, s) if kind == "biaxial" else s for s in stretches])
    solver = _solver()
    u, _ = solver.solve(load)
    edges = np.stack([resultants(solver, each, load) for each in u]) * THICKNESS
    side, fine = POINTS, FINER * (POINTS - 1) + 1
    measured = u.reshape(-1, fine, fine, 2)[:, ::FINER, ::FINER]
    measured = measured + np.random.default_rng(seed).normal(0.0, noise, measured.shape)
    force, moved = {}, {}
    for i, J in RESULTANTS[kind]:
        axis, edge = "xy"[i], EDGE_NAMES.index(("right", "top")[J])
        force[axis] = np.append(0.0, edges[:, edge, i])
        moved[axis] = np.append(0.0, load.H[:, i, J] * SIDE)
    frames = np.concatenate([np.zeros((1, side, side, 2)), measured])
    return Practice(np.linspace(0.0, SIDE, side), frames, moved, force)


def _solver() -> EquilibriumSolver:
    lines = np.linspace(0.0, SIDE, FINER * (POINTS - 1) + 1)
    mesh = rectilinear(lines, lines)
    inside = ellipse((RADIUS, RADIUS), CENTRE)(mesh.centres)
    mu = MATRIX + (INCLUSION - MATRIX) * inside
    return EquilibriumSolver(mesh, closed_form_stress(("neo_hookean",)), {"model": np.zeros_like(mu), "mu": mu})
