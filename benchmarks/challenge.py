"""A rehearsal of the 2025 Mechanical MNIST Challenge on virtual sheets that are made as its own were.

    python -m benchmarks.challenge [SHEETS_A_PAIR [ENGINE]]

Strokes of a pen are printed into squares of 40 mm, in four pairs of materials, clamped at two ends and pulled by 6 mm.
The lines that a printer lays make a sheet stiffer along or across the pull.
Cameras see a grid through an averaging window, with noise and in pixels. With an ENGINE, pyvale or al_dic, it follows
points through pictures of speckle instead. Millimetres are then scaled by the crosshead, though the clamps give way by
some of its travel. The first sheet of each pair has its label and tells the classes; the others are labelled without
it and scored by the challenge's rule. One label lies upside down, which must be said. Sheets that this very code has
done are in ``.cache/challenge``, and are not done again.
"""

import sys
from pathlib import Path

from hypernode.pipeline.compiler import set_up_compiler

set_up_compiler(float64=True)

import numpy as np

from benchmarks import challenge_sheets
from benchmarks.challenge_sheets import PAIRS, make
from hypernode.challenge.classes import mean_pairs, nearest_pair, pair_of_label
from hypernode.challenge.scoring import dice, turned
from hypernode.stages.challenge import named_as, run
from hypernode.storage.provenance import code_hash

FOLDER = Path(__file__).resolve().parents[1] / ".cache" / "challenge"


def phases(path: Path) -> tuple[np.ndarray, tuple[float, float]]:
    """(1 where a point is of the stiffer phase, stiffness of both) of a test; one that was done is not done again."""
    kept = path.with_suffix(".phases.npz")
    if not kept.exists():
        found = run(path)
        np.savez(kept, stiffer=found.stiffer, stress=found.stress)
    with np.load(kept) as held:
        return held["stiffer"], tuple(held["stress"])


def main(each: int = 2, engine: str = "") -> None:
    """Learn from the first sheet of every pair, label the others, and print the scores."""
    folder = FOLDER / "".join(code_hash(each)[:8] for each in (__file__, challenge_sheets.__file__)) / engine
    folder.mkdir(parents=True, exist_ok=True)
    tests = [(folder / f"{100 * k + n:03d}.npz", pair, n) for k, pair in enumerate(PAIRS) for n in range(each)]
    for path, pair, n in tests:
        if not path.exists():
            make(int(path.stem), pair, upside_down(pair, n), path, engine)
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
    main(*map(int, sys.argv[1:2]), *sys.argv[2:3])
