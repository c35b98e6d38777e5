"""Copies of one process: they run a job as a process of its own would, and nothing is left of one in the next."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from hypernode.pipeline.forking import FEWEST_JOBS, ForkServer, modules_of

pytestmark = pytest.mark.skipif(not hasattr(os, "pidfd_open"), reason="the system has no such processes")
SCRIPTS = Path(__file__).resolve().parents[2] / "workflow" / "scripts"
VARIABLES = {key: os.environ[key] for key in ("PATH", "HOME", "PYTHONPATH") if key in os.environ}


@pytest.fixture
def server():
    started = ForkServer(["hypernode.errors", "hypernode.no_such_module"])
    with contextlib.closing(started):
        yield started


def script(folder, text, name="job.py"):
    (folder / name).write_text(text)
    return str(folder / name)


def test_a_copy_ends_with_the_status_of_its_script(server, tmp_path):
    for text, wanted in (("", 0), ("raise SystemExit(3)", 3), ("1 / 0", 1), ("import os; os.kill(os.getpid(), 9)", -9)):
        assert server.run(script(tmp_path, text), VARIABLES) == wanted


def test_a_copy_has_the_modules_the_environment_and_the_folder_of_its_job_and_nothing_of_the_one_before(
    server, tmp_path, monkeypatch
):
    text = """
import hypernode.errors, os, sys
assert "hypernode.pipeline.job" in sys.modules
assert not hasattr(hypernode.errors, "left") and "BEFORE" not in os.environ
hypernode.errors.left, os.environ["BEFORE"] = True, "1"
open("seen", "a").write(os.environ["HERE"] + __name__ + sys.argv[0])
"""
    monkeypatch.chdir(tmp_path)
    for name in ("one.py", "two.py"):
        assert server.run(script(tmp_path, text, name), {**VARIABLES, "HERE": "here"}) == 0
    assert Path("seen").read_text() == "".join(f"here__main__{tmp_path}/{name}" for name in ("one.py", "two.py"))


def test_what_is_measured_is_the_process_of_the_job(server, tmp_path):
    seen = []
    text = f"import os; open({str(tmp_path / 'pid')!r}, 'w').write(str(os.getpid()))"
    assert server.run(script(tmp_path, text), VARIABLES, lambda pid: contextlib.nullcontext(seen.append(pid))) == 0
    assert seen == [int((tmp_path / "pid").read_text())]


def test_jobs_run_side_by_side(server, tmp_path):
    """Each of two waits for the other's file."""
    text = """
import pathlib, sys, time
mine, other = (pathlib.Path(sys.argv[0]).with_name(name) for name in {names})
mine.touch()
for _ in range(400):
    if other.exists():
        break
    time.sleep(0.05)
else:
    raise SystemExit(1)
"""
    ended = []
    names = (("a", "b"), ("b", "a"))
    jobs = [script(tmp_path, text.format(names=pair), f"{pair[0]}.py") for pair in names]
    threads = [threading.Thread(target=lambda job=job: ended.append(server.run(job, VARIABLES))) for job in jobs]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert ended == [0, 0]


def test_where_the_process_is_gone_no_copy_is_made_and_the_caller_is_told(server, tmp_path):
    assert server.run(script(tmp_path, ""), VARIABLES) == 0
    server._process.kill()
    server._process.wait()
    assert server.run(script(tmp_path, ""), VARIABLES) is None


def test_a_job_ends_with_the_process_that_it_is_a_copy_of(server, tmp_path):
    sign = tmp_path / "sign"
    text = f"""
import os, pathlib, time
from hypernode.pipeline.job import die_with_parent
die_with_parent()
pathlib.Path({str(sign)!r}).touch()
time.sleep(60)
"""
    ended = []
    thread = threading.Thread(target=lambda: ended.append(server.run(script(tmp_path, text), VARIABLES)))
    thread.start()
    while not sign.exists():
        time.sleep(0.05)
    server._process.kill()
    thread.join(timeout=20)
    assert ended == [-signal.SIGKILL]


@pytest.mark.parametrize("float64", [True, False])
def test_a_copy_of_a_process_that_has_imported_jax_computes_in_the_precision_of_its_rule(tmp_path, float64):
    text = f"""
import sys
assert "jax" in sys.modules
from hypernode.pipeline.compiler import set_up_compiler
set_up_compiler({float64})
import jax
from jax._src import xla_bridge
assert not xla_bridge.backends_are_initialized()
assert jax.numpy.ones(1).dtype == ("float64" if {float64} else "float32")
assert jax.config.jax_compilation_cache_dir.startswith({str(tmp_path)!r})
"""
    with contextlib.closing(ForkServer(["jax"])) as server:
        assert server.run(script(tmp_path, text), {**VARIABLES, "HYPERNODE_CACHE": str(tmp_path)}) == 0


def test_everything_that_a_script_reaches_is_imported_before_its_job_begins():
    found = modules_of([SCRIPTS / "forward.py"])
    assert {"hypernode.stages.forward", "hypernode.fem.solver", "hypernode.pipeline.job"} <= set(found)
    assert "hypernode.stages.pretraining" not in found


SNAKEFILE = """
from pathlib import Path
from hypernode.pipeline.forking import fork_jobs
onstart:
    fork_jobs(workflow, Path(workflow.basedir) / "scripts")
rule all:
    input: [f"{k}.txt" for k in range(COUNT)]
rule job:
    output: "{k}.txt"
    log: "{k}.log"
    benchmark: "{k}.jsonl"
    threads: 1
    script: "scripts/job.py"
"""
SCRIPT = """
import os, sys, time
if os.path.exists("fail"):
    raise RuntimeError("refused")
time.sleep(0.1)
open(snakemake.output[0], "w").write("copy" if "hypernode.pipeline.job" in sys.modules else "own")
"""


def run(folder, count, **variables):
    (folder / "scripts").mkdir(exist_ok=True)
    (folder / "scripts" / "job.py").write_text(SCRIPT)
    (folder / "Snakefile").write_text(SNAKEFILE.replace("COUNT", str(count)))
    line = [sys.executable, "-m", "snakemake", "--cores", "2", "--quiet", "all", "--forceall", "--keep-going"]
    return subprocess.run(
        line, cwd=folder, env={**os.environ, **variables}, capture_output=True, text=True, timeout=120
    )


def test_jobs_of_a_run_are_copies_where_there_are_enough_of_them_and_nobody_asked_otherwise(tmp_path):
    for count, variables, wanted in (
        (FEWEST_JOBS, {}, "copy"),
        (FEWEST_JOBS, {"HYPERNODE_FORK": "0"}, "own"),
        (1, {}, "own"),
    ):
        done = run(tmp_path, count, **variables)
        assert done.returncode == 0, done.stderr
        assert {(tmp_path / f"{k}.txt").read_text() for k in range(count)} == {wanted}
        assert all('"max_rss"' in (tmp_path / f"{k}.jsonl").read_text() for k in range(count))


def test_a_copy_that_fails_fails_its_job(tmp_path):
    (tmp_path / "fail").touch()
    done = run(tmp_path, FEWEST_JOBS)
    assert done.returncode == 1 and "RuntimeError: refused" in done.stderr
    assert not list(tmp_path.glob("*.txt"))
