"""Jobs: the process that started them, and what they set up before they compute."""

import os
import select
import subprocess
import sys

import pytest

from hypernode.storage import environment

JOB = """
import sys, time
from pathlib import Path
from hypernode.pipeline.job import die_with_parent
time.sleep(0.3)
die_with_parent()
time.sleep(0.5)
Path(sys.argv[1]).touch()
"""
#: Says the number of the job that it starts, and waits for it or ends at once.
PARENT = """
import subprocess, sys
job = subprocess.Popen([sys.executable, "-c", *sys.argv[1:3]])
print(job.pid, flush=True)
if sys.argv[3] == "lives":
    job.wait()
"""


def started(lifetime, sign):
    """Start a job by a parent that lives or ends, in a session of its own as on a terminal, and wait for both."""
    line = [sys.executable, "-c", PARENT, JOB, str(sign), lifetime]
    with subprocess.Popen(line, stdout=subprocess.PIPE, start_new_session=True) as parent:
        # A job that nobody takes leave of has ended all the same.
        ended = os.pidfd_open(int(parent.stdout.readline()))
        assert select.select([ended], [], [], 60)[0]
        os.close(ended)
    return sign.exists()


def test_a_job_works_on_while_its_parent_lives(tmp_path):
    assert started("lives", tmp_path / "sign")


def test_a_job_ends_whose_parent_died_before_it_asked_to_be_told(tmp_path):
    assert not started("ends", tmp_path / "sign")


def test_a_job_that_does_not_compute_with_jax_does_not_import_it():
    """One process imports them all: the first that brought JAX along would be seen with it."""
    code = "import sys, importlib, hypernode.pipeline.job\n"
    code += "for name in sys.argv[1:]:\n    importlib.import_module(name)\n    assert 'jax' not in sys.modules, name"
    modules = ["hypernode.stages.measurement", "hypernode.stages.gradient", "hypernode.tables.runs"]
    done = subprocess.run([sys.executable, "-c", code, *modules], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


def test_a_job_computes_in_the_precision_that_its_rule_asks_for():
    code = "import hypernode.pipeline.compiler as c; c.set_up_compiler({}); import jax; print(jax.numpy.ones(1).dtype)"
    for float64, wanted in ((True, "float64"), (False, "float32")):
        done = subprocess.run(
            [sys.executable, "-c", code.format(float64)], capture_output=True, text=True, check=True, timeout=60
        )
        assert done.stdout.strip() == wanted


def test_a_job_that_loads_what_another_one_compiled_says_nothing(tmp_path):
    code = "import hypernode.pipeline.compiler as c; c.set_up_compiler(True); import jax; jax.numpy.ones(9).sum()"
    variables = {**os.environ, "HYPERNODE_CACHE": str(tmp_path)}
    variables.pop("TF_CPP_MIN_LOG_LEVEL", None)
    for _ in ("compiles", "loads"):
        done = subprocess.run(
            [sys.executable, "-c", code], env=variables, capture_output=True, text=True, check=True, timeout=60
        )
        assert (done.stdout, done.stderr) == ("", "")
    assert [*tmp_path.glob("jax-*/*-cache")]


def test_processors_with_other_instructions_do_not_share_what_is_compiled(monkeypatch):
    found = set()
    for instructions in ("sse2 avx2", "avx2 sse2", "sse2 avx2 avx512f"):
        monkeypatch.setattr(environment, "_cpuinfo", {"flags": instructions}.get)
        found.add(environment.instruction_set.__wrapped__())
    assert len(found) == 2


def test_a_job_for_a_platform_that_is_not_here_ends_with_the_way_out(tmp_path):
    code = """
from types import SimpleNamespace
from hypernode.pipeline.job import job
class Params(dict):
    code = "none"
given = SimpleNamespace(
    rule="training", params=Params(platform="cuda"), wildcards={"case": "X"}, threads=1, log=["training.log"]
)
with job(given):
    print("begun")
"""
    variables = {key: value for key, value in os.environ.items() if key != "JAX_PLATFORMS"}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, env=variables, capture_output=True, text=True, timeout=60
    )
    if done.returncode == 0:
        pytest.skip("there is a device of CUDA here")
    assert done.returncode == 1 and "begun" not in done.stdout
    assert "error in training (case X): platform: cuda: JAX finds no such device here" in done.stderr
    assert "pip install -r requirements/gpu.txt" in done.stderr and "platform: cpu" in done.stderr
    assert "Traceback" not in done.stderr
