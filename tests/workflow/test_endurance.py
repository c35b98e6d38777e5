"""Accidents: kills at random moments and a full disk end in a clear state that a resume completes."""

import contextlib
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import yaml

from hypernode.storage.audit import verify
from hypernode.storage.netcdf import sha256

ROOT = Path(__file__).resolve().parents[2]
KILLS = 10


@pytest.fixture(autouse=True)
def _only_on_demand(request):
    if not request.config.getoption("--endurance"):
        pytest.skip("kills and full disks run with --endurance")


def command(folder, *arguments):
    line = [sys.executable, "-m", "snakemake", *arguments, "--snakefile", str(ROOT / "Snakefile"), "--cores", "2"]
    line += ["--profile", str(ROOT / "profiles/default"), "--directory", str(folder)]
    return [*line, "--configfile", str(folder / "config.yaml")]


def prepared(folder):
    """One small case of two methods, so that a run takes a minute and passes every stage."""
    config = yaml.safe_load((ROOT / "config/smoke.yaml").read_text())
    config["cases"] = {"disc": {**config["cases"]["disc"], "methods": ["tiny", "tiny_constrained"]}}
    config["figures"] = {"disc": config["figures"]["disc"]}
    config["tables"] = {"groups": config["tables"]["groups"]}
    config["explorers"] = []
    folder.mkdir()
    (folder / "config.yaml").write_text(yaml.safe_dump(config))
    return folder


def descendants(folder):
    """Processes that still work for a run in ``folder``."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if (process / "cwd").resolve() == folder and int(process.name) != os.getpid():
                found.append(int(process.name))
        except OSError:
            continue
    return found


def digests(folder):
    return {p.relative_to(folder): sha256(p) for p in sorted((folder / "results").rglob("*.nc"))}


@contextlib.contextmanager
def small_disk(folder, size):
    """A file system of its own for the results of a run."""
    disk = folder / "results"
    disk.mkdir()
    if subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={size}", "none", str(disk)], capture_output=True
    ).returncode:
        pytest.skip("mounting a small file system is not allowed here")
    try:
        yield disk
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def assert_stopped_by_full_disk(run, disk):
    """A failed run that says so and leaves no partial file."""
    said = run.stderr + run.stdout
    assert run.returncode != 0
    assert "cannot be written" in said or "No space left" in said, said[-3000:]
    assert not [p for p in disk.rglob("*") if ".tmp" in p.name]


def resumed(folder, *targets):
    """Unlock and run again, to the end."""
    subprocess.run(command(folder, "--unlock"), check=True, capture_output=True)
    done = subprocess.run(command(folder, "--rerun-incomplete", *targets), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]


def test_ten_kills_leave_no_orphan_and_the_resumed_results_are_the_same_bytes(tmp_path):
    whole = prepared(tmp_path / "whole")
    begun = time.monotonic()
    subprocess.run(command(whole), check=True, capture_output=True)
    duration = time.monotonic() - begun
    killed = prepared(tmp_path / "killed")
    moments = random.Random(4)
    for _ in range(KILLS):
        subprocess.run(command(killed, "--unlock"), check=True, capture_output=True)
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        run = subprocess.Popen(command(killed, "--rerun-incomplete"), **quiet)
        time.sleep(3.0 + moments.random() * duration / 3.0)
        run.send_signal(signal.SIGKILL)
        run.wait()
        time.sleep(1.5)
        assert descendants(killed) == []
    resumed(killed)
    assert digests(killed) == digests(whole)
    assert verify(killed / "results") == []


def test_a_full_disk_stops_with_one_line_and_the_run_goes_on_once_there_is_space(tmp_path):
    folder = prepared(tmp_path / "full")
    with small_disk(folder, "256k") as disk:
        assert_stopped_by_full_disk(subprocess.run(command(folder), capture_output=True, text=True), disk)
        subprocess.run(["mount", "-o", "remount,size=64m", str(disk)], check=True)
        resumed(folder)
        assert verify(disk) == []


STAGES = (
    *(
        f"results/disc/{stage}.nc"
        for stage in (
            "true_material",
            "forward",
            "measurement",
            "tiny_constrained/constrained",
            "tiny/gradient",
            "tiny/interpolant",
            "tiny/homogenised",
            "tiny/initialised",
            "tiny/pretrained",
            "tiny/material",
            "tiny/evaluation",
        )
    ),
    "results/figures/disc.pdf",
    "results/tables/groups.csv",
    "results/ro-crate-metadata.json",
)


def fill(disk):
    """Leave no byte on a file system."""
    with open(disk / "filler", "wb", buffering=0) as filler:
        for size in (2**20, 2**12, 1):
            with contextlib.suppress(OSError):
                while filler.write(bytes(size)):
                    pass


def test_a_disk_that_is_full_at_a_stage_gives_one_line_there_and_the_stage_runs_afterwards(tmp_path):
    folder = prepared(tmp_path / "full")
    with small_disk(folder, "64m") as disk:
        for index, target in enumerate(STAGES):
            if index:
                resumed(folder, *STAGES[:index])
            fill(disk)
            assert_stopped_by_full_disk(subprocess.run(command(folder, target), capture_output=True, text=True), disk)
            assert not (folder / target).exists(), target
            (disk / "filler").unlink()
            resumed(folder, target)
        assert verify(disk) == []
