"""A rehearsal of the 2025 Mechanical MNIST Challenge on virtual sheets that are made as its own were.

    python benchmarks/challenge.py [SHEETS_A_PAIR]

Strokes of a pen are printed into squares of 40 mm, in four pairs of materials, clamped at two ends and pulled by 6 mm.
Cameras see a grid through an averaging window, with noise and in pixels. Millimetres are then scaled by the crosshead,
though the clamps give way by some of its travel. The first sheet of each pair has its label and tells the classes; the
others are labelled without it and scored by the challenge's rule. One label lies upside down, which must be said.
"""

import json
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

from hypernode.pipeline.compiler import set_up_compiler

set_up_compiler(float64=True)

import numpy as np
from scipy.interpolate import CubicSpline

from hypernode.challenge.classes import mean_pairs, pair_of_label
from hypernode.challenge.scoring import dice
from hypernode.fem.mesh import rectilinear
from hypernode.fem.solver import EquilibriumSolver, closed_form_stress
from hypernode.identification.camera import window_average
from hypernode.mechanics.loads import make_load
from hypernode.stages.challenge import SIDE, THICKNESS, run
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


def make(number: int, pair: tuple[int, int], upside_down: bool, path: Path) -> None:
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
        label=label[::-1] if upside_down else label,
    )


def main(each: int = 2) -> None:
    """Learn from the first sheet of every pair, label the others, and print the scores."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    tests = [(100 * k + n, pair, n) for k, pair in enumerate(PAIRS) for n in range(each)]
    for number, pair, n in tests:
        make(number, pair, n == 1 and pair == (8, 4), FOLDER / f"{number:03d}.npz")
    learned = []
    for number, pair, _ in (test for test in tests if test[2] == 0):
        found = run(FOLDER / f"{number:03d}.npz")
        told = pair_of_label(found.test.label, found.stiffer, found.stress, str(number))
        learned.append(told)
        print(f"{number:03d} {pair}: tells {told}; shape {found.score:.3f}", flush=True)
    pairs = mean_pairs(learned)
    (FOLDER / "classes.json").write_text(json.dumps({"pairs": [p.stored() for p in pairs]}, indent=1) + "\n")
    scores, right = [], []
    for number, pair, _ in (test for test in tests if test[2] > 0):
        found = run(FOLDER / f"{number:03d}.npz", pairs)
        turned = [note for note in found.remarks if "turned" in note]
        upright = found.test.label[::-1] if turned else found.test.label
        scores.append(dice(upright, found.predicted_label))
        right.append((found.pair.soft, found.pair.stiff) == pair)
        print(
            f"{number:03d} {pair}: labelled {found.pair.soft}, {found.pair.stiff}; score {scores[-1]:.3f}"
            + (f" ({found.score:.3f} with its label as it is: said to be upside down)" if turned else ""),
            flush=True,
        )
    print(f"mean score {np.mean(scores):.3f}, lowest {np.min(scores):.3f}; classes right {np.mean(right):.0%}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
