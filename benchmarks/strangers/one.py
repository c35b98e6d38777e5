"""One sheet from its seed to its score, in a process of its own."""

import hashlib
import json
import os
import resource
import shutil
import subprocess
import sys
import time
from pathlib import Path

from benchmarks.strangers.design import design
from benchmarks.strangers.score import score, seconds_of_steps
from benchmarks.strangers.solve import solve
from benchmarks.strangers.write import write_test, write_truth
from hypernode.pipeline.compiler import set_up_compiler
from hypernode.storage.provenance import PACKAGE

ROOT = Path(__file__).resolve().parents[2]
#: Method that identifies a sheet.
METHOD = "hypernode"


class Failed(RuntimeError):
    """A sheet has no score."""


def main(seed: int, folder: Path) -> None:
    """Make the test of a seed, identify it, and write ``score.json``.

    What the workflow sees is ``folder/brought`` alone; the truth lies beside it.

    Raises:
        Failed: the workflow ended without a material; the end of what it said is in the message.
    """
    set_up_compiler(float64=True)
    sheet, brought, truth = design(seed), folder / "brought", folder / "truth.npz"
    made = folder / "made"
    if not made.exists():
        shutil.rmtree(folder, ignore_errors=True)
        equilibria = solve(sheet)
        write_test(sheet, equilibria, brought)
        write_truth(sheet, equilibria, truth)
        made.touch()
    code, took = identified(brought, "sheet.yaml")
    run = brought / "results" / "sheet" / METHOD
    if not (run / "evaluation.nc").is_file():
        raise Failed(reason(brought / "workflow.log"))
    known = {
        "code": version(),
        **{"seed": seed, "shape": sheet.shape, "law": sheet.kind, "load": sheet.load, "laws": sheet.phases},
        **{"points": sheet.points, "top": sheet.top, "seen": sheet.seen, "window": sheet.window, "noise": sheet.noise},
    }
    found = score(run, truth) | took
    # A material may be there where a page that shows it is not.
    found["error"] = "" if code == 0 else reason(brought / "workflow.log")
    found["steps"] = seconds_of_steps(brought / "results")
    (folder / "score.json").write_text(json.dumps(known | found, indent=1) + "\n")


def identified(brought: Path, config: str, *targets: str) -> tuple[int, dict]:
    """(exit code of the workflow on one core, its seconds by processor and clock).

    Args:
        brought: folder that it runs in.
        config: name of the configuration there.
        targets: files to make; all where none is named.
    """
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile"), "--cores", "1"]
    command += ["--workflow-profile", str(ROOT / "profiles" / "default"), "--quiet", "rules", "host", "reason"]
    # A study that was killed leaves a lock and half a file; nobody else works in this folder.
    command += ["--nolock", "--rerun-incomplete", "--configfile", config, "--", *targets]
    source = os.pathsep.join([str(PACKAGE.parent), os.environ.get("PYTHONPATH", "")])
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    with (brought / "workflow.log").open("w") as log:
        done = subprocess.run(
            command, cwd=brought, env={**os.environ, "PYTHONPATH": source}, stdout=log, stderr=subprocess.STDOUT
        )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return done.returncode, {"cpu_s": cpu, "clock_s": time.perf_counter() - begun}


def version() -> str:
    """One text for the package's code and how a sheet is made and scored."""
    digest = hashlib.sha256()
    for file in sorted([*PACKAGE.rglob("*.py"), *PACKAGE.rglob("*.yaml"), *Path(__file__).parent.glob("*.py")]):
        digest.update(file.read_bytes())
    return digest.hexdigest()[:12]


def reason(log: Path) -> str:
    """What a job said of its error, or the last line of a log that names one, or its last line."""
    lines = [line.strip() for line in log.read_text(errors="replace").splitlines() if line.strip()]
    told = [line for line in lines if line.startswith("error in ")]
    named = [line for line in lines if "Error" in line and not line.startswith(("Error in rule", "RuleException"))]
    return (told or named or lines or ["the workflow said nothing"])[-1][:300]


if __name__ == "__main__":
    main(int(sys.argv[1]), Path(sys.argv[2]))
