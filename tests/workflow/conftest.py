"""One small run of the whole pipeline, which many tests look at and none changes."""

import pytest

from tests.workflow.running import snakemake


@pytest.fixture(scope="session")
def smoke(request, tmp_path_factory):
    if not request.config.getoption("--smoke"):
        pytest.skip("the whole DAG runs with --smoke")
    folder = tmp_path_factory.mktemp("smoke")
    done = snakemake(folder)
    assert done.returncode == 0, done.stderr[-4000:]
    return folder
