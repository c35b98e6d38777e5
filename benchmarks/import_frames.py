"""Time and memory of reading a series of frames.

Frames of a sheet that is stretched by up to a tenth are written into a temporary folder as tables of x, y, u and v, as
a laboratory exports them, and read as a series: on a grid, on a grid that is tilted against the axes, on scattered
points, on scattered points whose rows stand in another order in every frame, and on a grid of which some points are
lost. Each is read in a process of its own on one core, so that its peak of memory is its own. Seconds are those of the
clock and those of the processor: where other work shares the core they differ.

Usage: python benchmarks/import_frames.py [--frames 100] [--points 200] [--cases grid scattered]
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:1])

import numpy as np

#: Angle of the tilted grid [rad]; largest offset of a scattered point, in steps; share of lost points.
ANGLE, OFFSET, LOST = 0.05, 0.2, 0.02
CASES = ("grid", "tilted", "scattered", "shuffled", "lost")


def positions(case: str, points: int) -> np.ndarray:
    """Reference positions [mm] of a case, a step of 0.1 mm apart."""
    lines = 0.1 * np.arange(points)
    X = np.stack(np.meshgrid(lines, lines), axis=-1).reshape(-1, 2)
    if case == "tilted":
        c, s = np.cos(ANGLE), np.sin(ANGLE)
        return X @ np.array([[c, s], [-s, c]])
    if case in ("scattered", "shuffled"):
        return X + 0.1 * OFFSET * np.random.default_rng(0).uniform(-1.0, 1.0, X.shape)
    return X


def write_frames(folder: Path, case: str, frames: int, points: int) -> None:
    """Frames with six decimals."""
    X, random = positions(case, points), np.random.default_rng(1)
    for k in range(frames):
        H = 0.1 * k / frames * np.array([[1.0, 0.1], [0.0, -0.4]])
        table = np.column_stack([X, X @ H.T])
        table = table[random.permutation(len(table))] if case == "shuffled" else table
        rows = (("%.6f,%.6f,%.6f,%.6f\n" * len(table)) % tuple(table.ravel().tolist())).splitlines()
        if case == "lost" and k:
            for row in np.flatnonzero(random.uniform(size=len(rows)) < LOST):
                rows[row] = ",".join([*rows[row].split(",")[:2], "", ""])
        (folder / f"frame{k:04d}.csv").write_text("\n".join(["x [mm],y [mm],u [mm],v [mm]", *rows, ""]))


def measure(folder: str) -> dict:
    """Read once and report (in a fresh process)."""
    from hypernode.dic.reading import read_series

    before = resource.getrusage(resource.RUSAGE_SELF)
    begun = time.perf_counter()
    series = read_series(Path(folder))
    seconds = time.perf_counter() - begun
    after = resource.getrusage(resource.RUSAGE_SELF)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    known = float(np.mean([np.isfinite(frame.displacement).mean() for frame in series.frames]))
    memory = after.ru_maxrss / 2**20
    return {"seconds": seconds, "processor_seconds": processor, "peak_memory_GB": memory, "share_known": known}


def main():
    """Measure every case, print the table and store it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=100)
    parser.add_argument("--points", type=int, default=200, help="along a side")
    parser.add_argument("--cases", nargs="+", choices=CASES, default=CASES)
    parser.add_argument("--one", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(measure(arguments.one)))
        return
    rows = []
    for case in arguments.cases:
        with tempfile.TemporaryDirectory() as folder:
            write_frames(Path(folder), case, arguments.frames, arguments.points)
            command = [sys.executable, __file__, "--one", folder]
            output = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        rows.append({"case": case, "frames": arguments.frames, "points": arguments.points**2} | json.loads(output))
        print(
            "{case}: {frames} frames of {points} points, {seconds:.1f} s, {processor_seconds:.1f} s of the processor, "
            "{peak_memory_GB:.2f} GB, {share_known:.1%} of the grid known".format(**rows[-1]),
            flush=True,
        )
    target = Path("results/benchmarks/import_frames.json")
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
