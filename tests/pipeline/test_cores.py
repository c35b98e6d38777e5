"""Jobs side by side compute on CPUs of their own, whatever folder they have for temporary files."""

import os
import subprocess
import sys

import pytest

from hypernode.pipeline.cores import claimed_cores

ALLOWED = sorted(os.sched_getaffinity(0))
JOB = """
import sys
from hypernode.pipeline.cores import claimed_cores
with claimed_cores(1, sys.argv[1]) as cpus:
    print(*cpus, flush=True)
    sys.stdin.read()
"""


def started(scope, folder):
    """A job that holds one CPU until its input ends, with a folder for temporary files of its own, and its CPU."""
    folder.mkdir()
    line = [sys.executable, "-c", JOB, scope]
    job = subprocess.Popen(
        line, env={**os.environ, "TMPDIR": str(folder)}, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    return job, int(job.stdout.readline())


def test_a_job_computes_on_its_cpus_and_gives_them_back():
    with claimed_cores(1, f"test-{os.getpid()}") as first:
        assert sorted(os.sched_getaffinity(0)) == first == ALLOWED[:1]
    assert sorted(os.sched_getaffinity(0)) == ALLOWED
    with claimed_cores(1, f"test-{os.getpid()}") as again:
        assert again == first


@pytest.mark.skipif(len(ALLOWED) < 2, reason="one CPU can only be shared")
def test_two_jobs_with_temporary_folders_of_their_own_have_two_cpus_until_they_are_killed(tmp_path):
    scope = f"test-{os.getpid()}-two"
    (one, first), (two, second) = (started(scope, tmp_path / name) for name in ("one", "two"))
    assert [first, second] == ALLOWED[:2]
    one.kill()
    one.wait()
    three, third = started(scope, tmp_path / "three")
    assert third == first
    for job in (two, three):
        job.communicate("")
        assert job.returncode == 0


def test_where_nothing_can_be_claimed_a_job_has_as_many_cpus_all_the_same(monkeypatch):
    def refused(*_):
        raise PermissionError

    monkeypatch.setattr("socket.socket", refused)
    with claimed_cores(1) as cpus:
        assert len(cpus) == 1 and set(cpus) <= set(ALLOWED)
        assert sorted(os.sched_getaffinity(0)) == cpus
