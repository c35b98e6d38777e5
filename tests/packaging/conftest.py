"""One wheel, which many environments are installed from."""

import pytest

from tests.packaging.environments import build


@pytest.fixture(scope="session")
def wheel(request, tmp_path_factory):
    if not (request.config.getoption("--wheel") or request.config.getoption("--pythons")):
        pytest.skip("a wheel is built and installed with --wheel or --pythons")
    return build(tmp_path_factory.mktemp("wheel"))
