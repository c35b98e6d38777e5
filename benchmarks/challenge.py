"""A rehearsal of the 2025 Mechanical MNIST Challenge on virtual sheets that are made as its own were.

    python benchmarks/challenge.py [SHEETS_A_PAIR]

Strokes of a pen are printed into squares of 40 mm, in four pairs of materials, clamped at two ends and pulled by 6 mm.
Cameras see a grid through an averaging window, with noise and in pixels. Millimetres are then scaled by the crosshead,
though the clamps give way by some of its travel. The first sheet of each pair has its label and tells the classes; the
others are labelled without it and scored by the challenge's rule. One label lies upside down, which must be said.
Sheets that were done are in ``.cache/challenge``, and are not done again.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

from hypernode.pipeline.compiler import set_up_compiler

set_up_compiler(float64=True)

import numpy as np
from scipy.interpolate import CubicSpline

from hypernode.challenge.classes import mean_pairs, nearest_pair, pair_of_label
from hypernode.challenge.scoring import dice, turned
from hypernode.fem.mesh import rectilinear
from hypernode.fem.solver import EquilibriumSolver, closed_form_stress
from hypernode.identification.camera import window_average
from hypernode.mechanics.loads import make_load
from hypernode.stages.challenge import SIDE, THICKNESS, named_as, run
from hypernode.synthetic.forward import resultants

FOLDER = ROOT / ".cache" / "challenge"
#: (label of the matrix, of the stroke) -> shear moduli [MPa], of a printer's elastomers.
PAIRS = {(8, 0): (0.20, 0.38), (9, 3): (0.23, 0.60), (8, 4): (0.20, 1.0), (9, 7): (0.23, 1.6)}
#: Points along a side, finite elements from one to the next, window in steps, noise in steps, frames, largest stretch.
POINTS, FINER, WINDOW, NOISE, FRAMES, STRETCH = 27, 2, 1.5, 0.01, 9, 1.15
#: Share of the crosshead's travel that clamps take, and where a force falls when the sheet tears.
CLAMPS, TORN = 0.05, 0.6


def stroke(random) -> np.ndarray:
    """Points of a pen's stroke in the unit square: a smooth curve through five places from the top down, as a digit."""
    x = 0.5 + 0.22 * random.uniform(-1.0, 1.0, 5)
    y = np.linspace(0.82, 0.18, 5) + random.uniform(-0.05, 0.05, 5)
    t = np.linspace(0.0, 4.0, 60)
    return np.stack([CubicSpline(np.arange(5), x)(t), CubicSpline(np.arange(5), y)(t)], axis=1)


def inside(X, curve, half: float):
    """Whether positions in the unit square lie within a half width of a curve."""
    return (np.linalg.norm(X[:, None] - curve[None], axis=2) < half).any(axis=1)


def make(number: int, pair: tuple[int, int], label_upside_down: bool, path: Path) -> None:
    """Write one test as the challenge writes them."""
    random = np.random.default_rng([number, 25])
    curve, half = stroke(random), random.uniform(0.055, 0.08)
    line = np.linspace(0.0, 1.0, FINER * (POINTS - 1) + 1)
    mesh = rectilinear(line, line)
    mu = np.where(inside(mesh.centres, curve, half), PAIRS[pair][1], PAIRS[pair][0])
    solver = EquilibriumSolver(mesh, closed_form_stress(("neo_hookean",)), {"model": np.zeros_like(mu), "mu": mu})
    stretch = np.linspace(1.0, STRETCH, FRAMES)[1:]
    load = make_load("clamped_y", stretch)
    found, _ = solver.solve(load)
    force = np.array([resultants(solver, u, load)[3, 1] for u in found]) * SIDE * THICKNESS
    seen = (window_average(mesh, WINDOW / (POINTS - 1)) @ found.reshape(len(found), -1).T).T.reshape(found.shape)
    seen = seen.reshape(len(found), len(line), len(line), 2)[:, ::FINER, ::FINER]
    pixels = 23.0 * (POINTS - 1)
    u = np.concatenate([np.zeros((1, POINTS, POINTS, 2)), seen]) * pixels
    u[1:] += 23.0 * NOISE * random.normal(size=u[1:].shape)
    grid = line[::FINER]
    X = np.stack(np.meshgrid(grid, grid), axis=-1)
    label = np.where(inside(X.reshape(-1, 2), curve, half), pair[1], pair[0]).reshape(POINTS, POINTS)
    # Rows of pictures run downward, and so do their displacements.
    X, u = pixels * X * [1.0, -1.0] + [0.0, pixels], u * [1.0, -1.0]
    travel = (stretch - 1.0) * SIDE / (1.0 - CLAMPS)
    crosshead = np.append(0.0, travel)
    recorded = np.append(0.0, force) + 0.003 * force.max() * random.normal(size=FRAMES)
    recorded[-1] *= TORN
    scale = crosshead[-1] / np.abs(u[..., 1]).max()
    np.savez(
        path,
        DIC_X=X * scale,
        DIC_disp=u * scale,
        instron_disp=crosshead,
        instron_force=recorded,
        label=label[::-1] if label_upside_down else label,
    )


def phases(path: Path) -> tuple[np.ndarray, tuple[float, float]]:
    """(1 where a point is of the stiffer phase, stiffness of both) of a test; one that was done is not done again."""
    kept = path.with_suffix(".phases.npz")
    if not kept.exists():
        found = run(path)
        np.savez(kept, stiffer=found.stiffer, stress=found.stress)
    with np.load(kept) as held:
        return held["stiffer"], tuple(held["stress"])


def main(each: int = 2) -> None:
    """Learn from the first sheet of every pair, label the others, and print the scores."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    tests = [(FOLDER / f"{100 * k + n:03d}.npz", pair, n) for k, pair in enumerate(PAIRS) for n in range(each)]
    for path, pair, n in tests:
        if not path.exists():
            make(int(path.stem), pair, upside_down(pair, n), path)
    learned = []
    for path, pair, _ in (test for test in tests if test[2] == 0):
        told = pair_of_label(np.load(path)["label"], *phases(path), path.name)
        learned.append(told)
        print(f"{path.stem} {pair}: tells {told}", flush=True)
    scores, right = [], []
    for path, pair, n in (test for test in tests if test[2] > 0):
        stiffer, stress = phases(path)
        label, found = np.load(path)["label"], nearest_pair(mean_pairs(learned), stress)
        predicted = np.where(stiffer == 1, found.stiff, found.soft)
        said = turned(label, named_as(label, stiffer), 0)
        scores.append(dice(label[::-1] if upside_down(pair, n) else label, predicted))
        right.append((found.soft, found.stiff) == pair)
        note = f"; its label is said to be {said}, and is" if said else ""
        print(f"{path.stem} {pair}: labelled {found.soft}, {found.stiff}; score {scores[-1]:.3f}{note}", flush=True)
        if said != ("turned up-down" if upside_down(pair, n) else ""):
            print(f"{path.stem}: the orientation of its label is taken for another one", flush=True)
    print(f"mean score {np.mean(scores):.3f}, lowest {np.min(scores):.3f}; classes right {np.mean(right):.0%}")


def upside_down(pair: tuple[int, int], number: int) -> bool:
    """Whether the label of a sheet lies upside down."""
    return number == 1 and pair == (8, 4)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
