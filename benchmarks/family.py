"""Sheets of one family, of which one is identified and all others are predicted from its laws.

    python benchmarks/family.py [SHEETS [FIRST]]

Every sheet has another shape of the same two laws. Its test is computed by other finite elements than the project's
(``benchmarks/strangers``). Cameras see a grid of points with noise, a load cell has a gain and a zero of its own. The
first sheet is identified; the picture of its shape and the test of every other one go to ``hypernode predict``.
"""

import json
import shutil
import sys
import time
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from hypernode.pipeline.compiler import set_up_compiler

set_up_compiler(float64=True)

import numpy as np
from PIL import Image

from benchmarks.measured import write_measurement
from benchmarks.strangers.design import SIDE, Sheet, design
from benchmarks.strangers.solve import solve
from hypernode.config.methods import Constrained
from hypernode.stages import constrained, prediction
from hypernode.storage.netcdf import read

FOLDER = ROOT / ".cache" / "family"
#: The two laws that all sheets have.
LAWS = {"mu": np.array([0.4, 1.0]), "second": np.array([0.1, 0.15]), "third": np.array([0.01, 0.02])}
SHAPES = ("islands", "strokes", "discs")
#: Points along a side, noise of a displacement [mm], largest mean strain, load steps, pixels of a picture's side.
POINTS, NOISE, TOP, LOADS, PIXELS = 33, 0.01, 0.15, 5, 330
SETTINGS = Constrained(terms=["I1_squared"], layers=True, posterior_samples=8, seed=1)


def member(seed: int) -> Sheet:
    """One sheet of the family: shape and load cell of the seed, laws and load of all."""
    own = design(seed)
    shape = SHAPES[seed % len(SHAPES)]
    return replace(own, shape=shape, kind="yeoh", load="clamped_y", laws=LAWS, top=TOP, points=POINTS, window=0.0)


def make(sheet: Sheet, folder: Path) -> None:
    """``measurement.nc``, ``shape.png`` and the true displacement of a sheet."""
    write_measurement(sheet, solve(sheet, LOADS), NOISE, folder / "measurement.nc")
    at = (np.arange(PIXELS) + 0.5) * SIDE / PIXELS
    X = np.stack(np.meshgrid(at, at[::-1]), axis=-1).reshape(-1, 2)
    second = sheet.weights(X)[:, 1].reshape(PIXELS, PIXELS)
    Image.fromarray((255 * second).astype(np.uint8)).save(folder / "shape.png")


def predicted(folder: Path, run: Path) -> dict:
    """The score of a prediction, and its distance from the displacement without noise."""
    measurement, output = folder / "measurement.nc", folder / "prediction.nc"
    target = prediction.Target(measurement=measurement, picture=folder / "shape.png")
    _, score = prediction.run([[prediction.LawFrom(run)]], target, output)
    true, u = read(measurement)["u_truth"].values, read(output)["u"].values
    error = np.linalg.norm(u - true, axis=(1, 2)) / np.linalg.norm(true, axis=(1, 2))
    return {**score.stored(), "against_truth": error.tolist()}


def main(sheets: int = 20, first: int = 1001) -> None:
    """Print a line for each sheet, and the medians."""
    folders = [FOLDER / str(seed) for seed in range(first, first + sheets)]
    for seed, folder in enumerate(folders, start=first):
        if not (folder / "shape.png").exists():
            shutil.rmtree(folder, ignore_errors=True)
            make(member(seed), folder)
    run = folders[0] / "run"
    if not (run / "constrained.nc").exists():
        run.mkdir(exist_ok=True)
        source = str(folders[0] / "measurement.nc")
        constrained.run(SETTINGS, "family", source, str(run / "constrained.nc"), {"rule": "benchmark"})
    print("sheet  shape    force off  displacement off  forces within two spreads   s")
    rows = []
    for seed, folder in list(enumerate(folders, start=first))[1:]:
        began = time.process_time()
        each = predicted(folder, run)
        rows.append((max(each["force_error"]), max(each["against_truth"]), each["force_within"]))
        force, u, within = rows[-1]
        took = time.process_time() - began
        print(
            f"{seed}   {member(seed).shape:8} {100 * force:5.2f} %     {100 * u:5.2f} %            {within:4.0%}"
            f"                     {took:3.0f}",
            flush=True,
        )
        (folder / "score.json").write_text(json.dumps(each, indent=1) + "\n")
    force, u, within = np.array(rows).T
    print(f"median: force {100 * np.median(force):.2f} %, displacement {100 * np.median(u):.2f} %")
    print(f"worst: force {100 * force.max():.2f} %, displacement {100 * u.max():.2f} %; within {within.mean():.0%}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
