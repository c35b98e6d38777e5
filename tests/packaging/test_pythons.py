"""Materials and configurations obey their laws with every Python that the package says it runs on."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.packaging.environments import ROOT, environment

VERSIONS = re.findall(r"Python :: (3\.\d+)", (ROOT / "pyproject.toml").read_text())
#: Tests that take no more than a bare installation and these packages.
TESTS = ("tests/config", "tests/mechanics", "tests/networks")
#: They start Snakemake, which a bare installation has not.
WITH_PIPELINE = (
    "tests/config/test_bad_input.py::test_an_unreadable_mask_and_a_path_outside_end_without_traceback",
    "tests/config/test_command_line.py::test_snakemake_plans_what_two_files_and_config_say_together",
)
TOOLS = ("pytest", "hypothesis", "jsonschema", "PyYAML")


def interpreter(version):
    """Path of a Python that starts, on the path or beside those that pyenv built; None where there is none."""
    built = sorted(Path.home().glob(f".pyenv/versions/{version}.*/bin/python"))
    for each in (shutil.which(f"python{version}"), *built):
        if each and subprocess.run([str(each), "-c", "import venv"], capture_output=True).returncode == 0:
            return each
    return None


@pytest.mark.parametrize("version", VERSIONS)
def test_laws_hold(version, request, tmp_path):
    if not request.config.getoption("--pythons"):
        pytest.skip("tests run with every Python with --pythons")
    if (python := interpreter(version)) is None:
        pytest.skip(f"there is no Python {version} here")
    pinned = re.findall(rf"^({'|'.join(TOOLS)})(==\S+)$", (ROOT / "requirements/dev.txt").read_text(), re.MULTILINE)
    assert len(pinned) == len(TOOLS)
    wheel = request.getfixturevalue("wheel")
    with environment(tmp_path / "venv", python) as installed:
        installed.install(wheel, *map("".join, pinned))
        left_out = [f"--deselect={test}" for test in WITH_PIPELINE]
        done = installed.run("python", "-m", "pytest", "-q", "-p", "no:cacheprovider", *left_out, *TESTS, cwd=ROOT)
    print(done.stdout.splitlines()[-1], f"with Python {version}")
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
    assert re.search(r"\d+ passed", done.stdout) and "skipped" not in done.stdout, done.stdout[-2000:]
