"""Whether training and the forward problem give on a device of CUDA what they give on the CPU, and how long they take.

Each platform computes in a process of its own: the forward problem of a small sheet in double precision, then the
homogenised material and the pre-training of the default method on it in single precision, from the same seeds. Fields
are compared relative to their largest value; beyond 1e-4 the exit code is 1. ``requirements/gpu.txt`` and a device
are needed.

Usage: python benchmarks/on_gpu.py [--cells 50] [--iterations 200] [--platforms cpu cuda]
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

#: Largest relative difference of two platforms.
TOLERANCE = 1e-4


def configuration(cells: int, iterations: int) -> dict:
    """A stiff disc in a sheet, and the default method with few iterations and without an equilibrium field."""
    stretches = [1.05, 1.1, 1.15, 1.2]
    short = {"iterations": iterations}
    return {
        "geometries": {"disc": {"shape": "disc", "radius": 0.25}},
        "materials": {k: {"model": "neo_hookean", "mu": mu} for k, mu in (("soft", 1.0), ("stiff", 2.0))},
        "loads": {"load": {"kind": "equibiaxial", "stretches": stretches}},
        "methods": {"short": {"extends": "hypernode", "constrained": None, "homogenised": short, "pretraining": short}},
        "cases": {
            "sheet": {
                "geometry": "disc",
                "inclusion": "stiff",
                "matrix": "soft",
                "loads": ["load"],
                "cells": [cells, cells],
                "methods": ["short"],
            }
        },
    }


def compute(platform: str, cells: int, iterations: int, folder: Path) -> dict:
    """Every stage on one platform; returns their times and leaves their files."""
    from hypernode.config.loading import check_config
    from hypernode.pipeline.compiler import require_platform, set_up_compiler

    set_up_compiler(float64=True, platform=platform)
    require_platform(platform)
    import jax
    import numpy as np

    from hypernode.material.files import load_material
    from hypernode.stages import forward, gradient, homogenised, measurement, pretraining, true_material
    from hypernode.storage.netcdf import read

    config = check_config(configuration(cells, iterations))
    method, attributes = config.methods["short"], {"rule": "benchmark"}
    names = ("truth", "forward", "measurement", "gradient", "homogenised", "material")
    files = {name: str(folder / f"{name}.nc") for name in names}
    times = {"device": str(jax.devices()[0])}

    def timed(name, run):
        begun = time.perf_counter()
        run()
        times[f"{name}_s"] = time.perf_counter() - begun

    true_material.run(config, "sheet", files["truth"], attributes)
    timed("forward", lambda: forward.run(config, "sheet", files["truth"], files["forward"], attributes))
    measurement.run(config, "sheet", files["forward"], files["measurement"], attributes)
    gradient.run(method.gradient, "sheet", files["measurement"], files["gradient"], attributes)
    jax.config.update("jax_enable_x64", False)
    learnt = {"measurement": files["measurement"], "field": files["gradient"]}
    timed("homogenised", lambda: homogenised.run(method, "sheet", learnt, files["homogenised"], attributes))
    learnt["homogenised"] = files["homogenised"]
    timed("pretraining", lambda: pretraining.run(method, "sheet", learnt, files["material"], attributes))
    truth = read(files["measurement"])
    X = truth["X"].values[truth["cells"].values].mean(axis=1)
    P = load_material(files["material"]).stress(X, np.tile(np.diag([1.1, 1.05]), (len(X), 1, 1)))
    np.savez(
        folder / "compared.npz",
        forward=read(files["forward"])["u"].values,
        homogenised=read(files["homogenised"])["P_homogenised"].values,
        stress=np.asarray(P),
    )
    return times


def main() -> int:
    """Print and store the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, default=50)
    parser.add_argument("--iterations", type=int, default=200)
    parser.add_argument("--platforms", nargs=2, default=["cpu", "cuda"])
    parser.add_argument("--one", nargs=2, metavar=("PLATFORM", "FOLDER"), help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.one:
        print(json.dumps(compute(given.one[0], given.cells, given.iterations, Path(given.one[1]))))
        return 0
    import numpy as np

    sizes = ["--cells", str(given.cells), "--iterations", str(given.iterations)]
    environment = {key: value for key, value in os.environ.items() if key != "JAX_PLATFORMS"}
    with tempfile.TemporaryDirectory() as folder:
        rows, fields = [], []
        for number, platform in enumerate(given.platforms):
            place = Path(folder) / str(number)
            place.mkdir()
            line = [sys.executable, __file__, *sizes, "--one", platform, str(place)]
            done = subprocess.run(line, env=environment, stdout=subprocess.PIPE, text=True)
            if done.returncode:
                return done.returncode
            rows.append(json.loads(done.stdout.splitlines()[-1]))
            print(platform, rows[-1], flush=True)
            with np.load(place / "compared.npz") as opened:
                fields.append(dict(opened))
    one, other = fields
    differences = {key: float(np.abs(one[key] - other[key]).max() / np.abs(one[key]).max()) for key in one}
    for key, value in differences.items():
        print(f"{key}: relative difference {value:.1e}{'' if value <= TOLERANCE else ', more than allowed'}")
    result = dict(zip(given.platforms, rows, strict=False)) | {"relative_differences": differences}
    out = Path("results/benchmarks/on_gpu.json")
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps(result, indent=1) + "\n")
    return int(max(differences.values()) > TOLERANCE)


if __name__ == "__main__":
    sys.exit(main())
