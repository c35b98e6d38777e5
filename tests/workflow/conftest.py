"""One small run of the whole pipeline, which many tests look at and none changes."""

import fcntl
import json
from pathlib import Path

import pytest

from tests.workflow.running import snakemake


@pytest.fixture(scope="session")
def smoke(request, tmp_path_factory, worker_id):
    """The folder of the run. Processes that share the tests share it: the first one runs, the others wait for it."""
    if not request.config.getoption("--smoke"):
        pytest.skip("the whole DAG runs with --smoke")
    own = tmp_path_factory.getbasetemp()
    shared = own if worker_id == "master" else own.parent
    folder, ended = shared / "smoke", shared / "smoke.json"
    with Path(shared / "smoke.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not ended.exists():
            folder.mkdir()
            done = snakemake(folder)
            ended.write_text(json.dumps([done.returncode, done.stderr]))
    code, said = json.loads(ended.read_text())
    assert code == 0, said[-4000:]
    return folder
