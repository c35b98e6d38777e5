"""Running the workflow in a folder of its own, and reading what it plans and leaves."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import xarray as xr

ROOT = Path(__file__).resolve().parents[2]
#: What is compiled once for all runs: where the other tests keep it too, in the precision of a job.
COMPILED = ROOT / ".cache"


def snakemake(folder, *arguments, config=ROOT / "config" / "smoke.yaml", compiled=COMPILED):
    command = [sys.executable, "-m", "snakemake", *arguments, "--snakefile", str(ROOT / "Snakefile")]
    command += ["--profile", str(ROOT / "profiles" / "default"), "--directory", str(folder), "--cores", "2"]
    command += ["--configfile", str(config)]
    environment = {**os.environ, "HYPERNODE_CACHE": str(compiled)}
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, env=environment)


def copied(folder, target):
    """A copy of a run, without what another process that plans in its folder at the same time writes and deletes."""
    shutil.copytree(folder, target, ignore=shutil.ignore_patterns("locks", "log", "iocache"))
    return target


def declared(plan, *keys):
    """The files that the jobs of a dry run name after some words, such as ``output:``."""
    lines = [line.split() for line in plan.splitlines()]
    return {name.strip(",") for words in lines if words[:1] and words[0] in keys for name in words[1:]}


def summary_of(path):
    """The numbers that an evaluation or a validation sums up."""
    with xr.open_dataset(path, decode_times=False) as data:
        return json.loads(data.attrs["summary"])
