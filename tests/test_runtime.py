"""Jobs and the process that started them."""

import subprocess
import sys
import time

JOB = """
import sys, time
from pathlib import Path
from hypernode.runtime import die_with_parent
time.sleep(0.3)
die_with_parent()
time.sleep(0.5)
Path(sys.argv[1]).touch()
"""
PARENT = "import subprocess, sys, time; subprocess.Popen([sys.executable, '-c', *sys.argv[1:3]]); time.sleep({})"


def started(lifetime, sign):
    """Start a job by a parent that lives for a while, in a session of its own as on a terminal, and wait for both."""
    subprocess.run(
        [sys.executable, "-c", PARENT.format(lifetime), JOB, str(sign)], check=True, start_new_session=True, timeout=60
    )
    time.sleep(4.0 - min(lifetime, 4.0))
    return sign.exists()


def test_a_job_works_on_while_its_parent_lives(tmp_path):
    assert started(4.0, tmp_path / "sign")


def test_a_job_ends_whose_parent_died_before_it_asked_to_be_told(tmp_path):
    assert not started(0.0, tmp_path / "sign")
