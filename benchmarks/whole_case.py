"""Time from a measurement file to the identified material, stage by stage, on one core after imports.

Every case runs in a process of its own, twice: with an empty compilation cache, and with the one that the first run
left. Imports are timed apart. Where ``training_step.py`` has run before, the sum is also compared with the published
schedule: 40 000 steps of the published algorithm at the step time measured there.

Usage: python benchmarks/whole_case.py [--config config/config.yaml] [--results results] [--method hypernode] CASE ...
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PUBLISHED_STEPS = 40_000


def stages(config, case: str, method_name: str, measurement: str, folder: Path):
    """(name, double precision, function) of every stage of a method, in order."""
    from hypernode.stages import constrained, gradient, homogenised, initialisation, interpolant, pretraining, training

    method = config.methods[method_name]
    attributes = {"rule": "benchmark"}
    made = {name: str(folder / f"{name}.nc") for name in ("constrained", "gradient", "interpolant", "homogenised")}
    files = {"measurement": measurement, "field": made["interpolant" if method.interpolant else "gradient"]}
    if method.constrained:
        files["constrained"] = made["constrained"]
        yield (
            "constrained",
            True,
            lambda: constrained.run(method.constrained, case, measurement, made["constrained"], attributes),
        )
    yield (
        "gradient",
        False,
        lambda: gradient.run(
            method.gradient, case, measurement, made["gradient"], attributes, files.get("constrained")
        ),
    )
    if method.interpolant:
        yield (
            "interpolant",
            False,
            lambda: interpolant.run(
                method.interpolant,
                method.seed,
                case,
                made["gradient"],
                made["interpolant"],
                attributes,
                method.normalised,
            ),
        )
    yield (
        "homogenised",
        False,
        lambda given=dict(files): homogenised.run(method, case, given, made["homogenised"], attributes),
    )
    files["homogenised"] = made["homogenised"]
    previous = None
    for stage in (initialisation, pretraining, training):
        name = stage.__name__.rsplit(".", 1)[1]
        if not getattr(method, name).iterations:
            continue
        output = str(folder / f"{name}.nc")
        given = files if previous is None else {**files, "previous": previous}
        yield (
            name,
            False,
            lambda stage=stage, given=given, output=output: stage.run(method, case, given, output, attributes),
        )
        previous = output


def once(given) -> None:
    """Run one case in this process and print its times as JSON."""
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:1])
    os.environ.setdefault("JAX_PLATFORMS", "cpu")
    begun = time.perf_counter()
    from hypernode.config.loading import load_config
    from hypernode.pipeline.compiler import set_up_compiler

    set_up_compiler(float64=False)
    import jax

    config = load_config(given.config)
    times = {}
    (case,) = given.cases
    with tempfile.TemporaryDirectory() as folder:
        todo = stages(config, case, given.method, f"{given.results}/{case}/measurement.nc", Path(folder))
        for name, float64, run in todo:
            if not times:
                times["imports"] = time.perf_counter() - begun
            jax.config.update("jax_enable_x64", float64)
            start = time.perf_counter()
            run()
            times[name] = time.perf_counter() - start
    print(json.dumps(times))


def main():
    """Print and store the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("cases", nargs="+")
    parser.add_argument("--config", default="config/config.yaml")
    parser.add_argument("--results", default="results")
    parser.add_argument("--method", default="hypernode")
    parser.add_argument("--once", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.once:
        once(given)
        return
    missing = [f"{given.results}/{case}/measurement.nc" for case in given.cases]
    missing = " ".join(file for file in missing if not Path(file).is_file())
    if missing:
        parser.error(f"no measurement of every case: run snakemake --cores 2 {missing}")
    step = Path(given.results) / "benchmarks" / "training_step.json"
    published = PUBLISHED_STEPS * json.loads(step.read_text())["published"]["median_s"] if step.is_file() else None
    rows = []
    for case in given.cases:
        with tempfile.TemporaryDirectory() as cache:
            for state in ("empty", "filled"):
                line = [sys.executable, __file__, "--once", "--config", given.config, "--results", given.results]
                line += ["--method", given.method, case]
                done = subprocess.run(
                    line, env={**os.environ, "HYPERNODE_CACHE": cache}, stdout=subprocess.PIPE, text=True, check=True
                )
                times = json.loads(done.stdout.splitlines()[-1])
                imports = times.pop("imports")
                total = sum(times.values())
                row = {"case": case, "method": given.method, "cache": state, "imports_s": imports, "total_s": total}
                row |= {f"{name}_s": value for name, value in times.items()}
                if published:
                    row["times_less_than_published"] = published / total
                rows.append(row)
                parts = ", ".join(f"{name} {value:.1f}" for name, value in times.items())
                ratio = f", {published / total:.0f} times less than published" if published else ""
                print(f"{case}, cache {state}: {total:.1f} s ({parts}), imports {imports:.1f} s{ratio}", flush=True)
    out = Path(given.results) / "benchmarks" / "whole_case.json"
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
