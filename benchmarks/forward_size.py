"""Time and memory of the forward problem against the size of its mesh.

A neo-Hookean sheet with an inclusion twice as stiff, stretched equibiaxially in one step of 1.1; every size in
a process of its own, so that the peak of memory is its own. The exponents are the slope of log(time) and
log(memory) over log(cells along a side) between the two largest meshes.

Usage: python benchmarks/forward_size.py [--cells 50 100 200 400]
"""

import argparse
import json
import math
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

os.environ.setdefault("JAX_PLATFORMS", "cpu")
os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:1])


def measure(cells: int) -> dict:
    """Solve once and report (in a fresh process)."""
    import jax

    jax.config.update("jax_enable_x64", True)
    import numpy as np

    from hypernode.fem.mesh import rectilinear
    from hypernode.fem.solver import EquilibriumSolver, closed_form_stress
    from hypernode.mechanics.loads import make_load

    lines = np.linspace(0.0, 1.0, cells + 1)
    mesh = rectilinear(lines, lines)
    mu = 1.0 + (np.linalg.norm(mesh.centres - 0.5, axis=1) < 0.25)
    begun = time.perf_counter()
    params = {"model": np.zeros(len(mu)), "mu": mu}
    solver = EquilibriumSolver(mesh, closed_form_stress(("neo_hookean",)), params)
    _, residuals = solver.solve(make_load("equibiaxial", [1.1]))
    return {
        "cells": cells,
        "seconds": time.perf_counter() - begun,
        "peak_memory_GB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
        "residual": float(residuals[-1]),
    }


def main():
    """Measure every size, print the table and store it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, nargs="+", default=[50, 100, 200, 400])
    parser.add_argument("--one", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(measure(arguments.one)))
        return
    rows = []
    for cells in arguments.cells:
        line = [sys.executable, __file__, "--one", str(cells)]
        rows.append(json.loads(subprocess.run(line, check=True, capture_output=True, text=True).stdout))
        row = rows[-1]
        print(f"{cells:4d} x {cells:<4d} {row['seconds']:8.1f} s {row['peak_memory_GB']:6.2f} GB", flush=True)
    result = {"rows": rows}
    if len(rows) > 1:
        for key in ("seconds", "peak_memory_GB"):
            ratio = math.log(rows[-1][key] / rows[-2][key]) / math.log(rows[-1]["cells"] / rows[-2]["cells"])
            result[f"exponent_{key}"] = ratio
            print(f"{key} grows as cells^{ratio:.2f}")
    path = Path("results/benchmarks/forward_size.json")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
