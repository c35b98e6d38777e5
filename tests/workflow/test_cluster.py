"""A cluster gives the bytes that one machine gives, and nothing is lost where it ends jobs."""

import copy
import functools
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import yaml

from hypernode.pipeline.nodes import machine
from hypernode.storage.audit import verify
from hypernode.storage.netcdf import sha256
from tests.workflow.local_queue import installed, jobs

ROOT = Path(__file__).resolve().parents[2]
TARGET = "results/disc/few/gradient.nc"
#: Rules of the first group, and what they declare here: too little for any interpreter with JAX, then enough.
TOO_LITTLE = [f"{rule}:mem_mb=330*attempt**3" for rule in ("true_material", "forward", "measurement")]
CONFIG = {
    "geometries": {"disc": {"shape": "disc", "radius": 0.25}},
    "materials": {"soft": {"model": "neo_hookean", "mu": 1.0}, "stiff": {"model": "neo_hookean", "mu": 2.0}},
    "loads": {"pull": {"kind": "equibiaxial", "stretches": [1.1]}},
    "methods": {"few": {"baseline": "constrained", "constrained": {"terms": [], "iterations": 3}}},
    "cases": {
        "disc": {
            **{"geometry": "disc", "inclusion": "stiff", "matrix": "soft", "loads": ["pull"]},
            **{"cells": [8, 8], "methods": ["few"]},
        }
    },
}


def line_of(folder, profile, config, *arguments):
    line = [sys.executable, "-m", "snakemake", *arguments, "--snakefile", str(ROOT / "Snakefile"), "--jobs", "2"]
    line += ["--profile", str(ROOT / "profiles" / profile), "--directory", str(folder), "--latency-wait", "10"]
    return [*line, "--configfile", str(config)]


def command(folder, profile, *arguments, long=False):
    folder.mkdir(exist_ok=True)
    config = copy.deepcopy(CONFIG)
    if long:
        config["cases"]["disc"]["cells"] = [120, 120]
        config["loads"]["pull"]["stretches"] = [1 + 0.01 * step for step in range(1, 31)]
    (folder / "config.yaml").write_text(yaml.safe_dump(config))
    return [*line_of(folder, profile, folder / "config.yaml", TARGET), *arguments]


def whole(folder, profile, *arguments):
    """The command that runs the small configuration, every rule of it."""
    return [*line_of(folder, profile, ROOT / "config" / "smoke.yaml"), *arguments]


def finished(line, environment):
    """Run a command to its end, within an hour."""
    done = subprocess.run(line, capture_output=True, text=True, env=environment, timeout=3600)
    assert done.returncode == 0, done.stderr[-3000:]


def on_nodes(environment):
    """Nodes find the package where this process finds it, whatever folder they start in."""
    return {**environment, "PYTHONPATH": str(ROOT / "src")}


def everything(folder):
    """Digests of all results and figures, without their records, which say how long they took."""
    drawn = {p.relative_to(folder): sha256(p) for p in sorted((folder / "results/figures").rglob("*.p[dn][fg]"))}
    assert drawn
    return drawn | digests(folder)


def digests(folder):
    return {p.relative_to(folder): sha256(p) for p in sorted((folder / "results").rglob("*.nc"))}


@pytest.fixture(scope="module", autouse=True)
def _only_on_demand(request):
    if not (request.config.getoption("--cluster") or request.config.getoption("--slurm")):
        pytest.skip("runs on a queue of this machine with --cluster, on a Slurm of one node with --slurm")


@pytest.fixture(scope="module")
def local(tmp_path_factory):
    """The digests of a run on this machine."""
    folder = tmp_path_factory.mktemp("here")
    finished(command(folder, "default"), on_nodes(os.environ))
    return digests(folder)


@pytest.fixture(scope="module")
def local_whole(tmp_path_factory):
    """The digests of the small configuration on this machine."""
    folder = tmp_path_factory.mktemp("whole")
    finished(whole(folder, "default"), on_nodes(os.environ))
    return everything(folder)


@pytest.fixture
def queue(request, tmp_path):
    if not request.config.getoption("--cluster"):
        pytest.skip("runs with --cluster")
    return on_nodes(installed(tmp_path / "queue"))


def test_a_job_killed_for_memory_comes_back_with_more_and_the_bytes_are_those_of_one_machine(local, queue, tmp_path):
    line = command(tmp_path / "run", "cluster-generic", "--set-resources", *TOO_LITTLE)
    finished(line, queue)
    killed, again, last = jobs(tmp_path / "queue")
    assert (killed["state"], again["state"], last["state"]) == ("OUT_OF_MEMORY", "COMPLETED", "COMPLETED")
    assert killed["asked"] < again["asked"]
    assert all(1.25 * job["peak"] < job["asked"] for job in (again, last)), "declared: a quarter more than is taken"
    assert digests(tmp_path / "run") == local
    assert all(finding.notice for finding in verify(tmp_path / "run" / "results"))
    # What is compiled is kept for this machine alone, outside the job's own folder for temporary files.
    assert [path.name for path in (tmp_path / "run" / ".cache").iterdir()] == [machine()]


def test_every_rule_of_the_small_configuration_has_the_bytes_of_one_machine(local_whole, queue, tmp_path):
    line = whole(tmp_path / "run", "cluster-generic", "--max-status-checks-per-second", "5")
    finished(line, queue)
    assert everything(tmp_path / "run") == local_whole


def _run_with_a_job_at_work(folder, queue_folder, environment):
    """A Snakemake, started, one of whose jobs has begun to compute, a minute's work."""
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    # What is started in the background of a script inherits that interrupts are ignored.
    heeding = functools.partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    line = command(folder, "cluster-generic", long=True)
    run = subprocess.Popen(line, env=environment, start_new_session=True, preexec_fn=heeding, **quiet)
    end = time.monotonic() + 60
    while time.monotonic() < end and not list((folder / "results/logs").rglob("forward.log")):
        time.sleep(0.1)
    assert run.poll() is None
    assert [job["state"] for job in jobs(queue_folder)] == ["RUNNING"]
    return run


def test_an_interrupted_run_takes_its_jobs_back(queue, tmp_path):
    run = _run_with_a_job_at_work(tmp_path / "run", tmp_path / "queue", queue)
    run.send_signal(signal.SIGINT)
    assert run.wait(timeout=60) != 0
    assert [job["state"] for job in jobs(tmp_path / "queue")] == ["CANCELLED"]
    assert not list((tmp_path / "run/.snakemake/locks").glob("*"))


def test_a_folder_is_not_idle_while_a_job_outlives_the_run_that_sent_it(queue, tmp_path):
    run = _run_with_a_job_at_work(tmp_path / "run", tmp_path / "queue", queue)
    run.kill()
    run.wait()
    subprocess.run(["scontrol", "show", "job", "1"], env=queue, check=True, capture_output=True)
    idle = [sys.executable, "-m", "hypernode", "idle"]
    asked = subprocess.run(idle, cwd=tmp_path / "run", env=queue, capture_output=True, text=True, timeout=60)
    subprocess.run(["scancel", "1"], env=queue, check=True)
    assert asked.returncode == 1 and "case disc" in asked.stderr
    assert subprocess.run(idle, cwd=tmp_path / "run", env=queue, timeout=60).returncode == 0


@pytest.fixture(scope="module")
def slurm(request, tmp_path_factory):
    """A Slurm of one node, taken down at the end."""
    if not request.config.getoption("--slurm"):
        pytest.skip("runs with --slurm")
    script, folder = str(ROOT / "tests/workflow/one_node_slurm.sh"), tmp_path_factory.mktemp("slurm")
    subprocess.run([script, "start", str(folder)], check=True, timeout=60)
    try:
        yield on_nodes(os.environ)
    finally:
        subprocess.run([script, "stop", str(folder)], check=True, timeout=60)


@pytest.mark.parametrize("profile", ["slurm", "cluster-generic"])
def test_slurm_gives_the_bytes_of_one_machine_though_it_kills_for_memory(profile, local, slurm, tmp_path):
    own = []
    if profile == "slurm":
        # It has no accounting to be asked.
        own = ["--slurm-status-command", "squeue", "--slurm-init-seconds-before-status-checks", "5"]
    line = command(tmp_path / "run", profile, *own, "--set-resources", *TOO_LITTLE)
    finished(line, slurm)
    listed = ["squeue", "--states=all", "--noheader", "--format=%i %T %m"]
    states = [each.split() for each in subprocess.check_output(listed, text=True).splitlines()]
    states = [(state, int(memory.rstrip("M"))) for _, state, memory in sorted(states, key=lambda w: int(w[0]))][-3:]
    assert [state for state, _ in states] == ["FAILED", "COMPLETED", "COMPLETED"]
    assert states[0][1] < states[1][1]
    assert digests(tmp_path / "run") == local


def test_every_rule_of_the_small_configuration_has_the_bytes_of_one_machine_through_slurm(local_whole, slurm, tmp_path):
    line = whole(tmp_path / "run", "cluster-generic", "--max-status-checks-per-second", "5")
    finished(line, slurm)
    assert everything(tmp_path / "run") == local_whole
