"""A wheel of the project, installed in a new environment without the repository, does what is promised of it."""

import json

import numpy as np
import pytest

from tests.packaging.environments import ROOT, environment
from tests.packaging.materials import F, X, write_materials
from tests.workflow.test_identify import TINY

#: Longest that `import hypernode` may take [s].
IMPORT = 2.0
SIZE = ("--size", "20", "20", "1", "--frame-rate", "1")


@pytest.fixture(scope="session")
def bare(wheel, tmp_path_factory):
    with environment(tmp_path_factory.mktemp("bare")) as installed:
        installed.install(wheel)
        yield installed


def test_materials_are_loaded_and_give_the_stress_of_here(bare, tmp_path):
    code = (
        "import json, sys, numpy, hypernode\n"
        "F, X = (numpy.array(each) for each in json.loads(sys.argv[1]))\n"
        "found = [numpy.asarray(hypernode.load_material(path).stress(X, F)).tolist() for path in sys.argv[2:]]\n"
        "print(json.dumps(found), 'snakemake' in sys.modules, 'jax_fem' in sys.modules)\n"
    )
    wanted = write_materials(tmp_path)
    out = bare.python(code, json.dumps([F.tolist(), X.tolist()]), *wanted, cwd=tmp_path)
    stress, _, imported = out.strip().partition("]]]] ")
    assert imported == "False False"
    np.testing.assert_allclose(json.loads(stress + "]]]]"), list(wanted.values()), rtol=1e-5, atol=1e-6)


def test_importing_is_quick(bare):
    code = "import time; start = time.perf_counter(); import hypernode; print(time.perf_counter() - start)"
    assert float(bare.python(code)) <= IMPORT


def test_help_names_every_command(bare):
    done = bare.run("hypernode", "--help")
    assert done.returncode == 0
    for command in ("practice", "inspect", "identify", "audit", "verdict", "schema", "export-csv"):
        assert command in done.stdout


def test_what_needs_the_pipeline_says_so_in_one_sentence(bare, tmp_path):
    for words in (("practice", "new"), ("identify", "pull", *SIZE)):
        done = bare.run("hypernode", *words, cwd=tmp_path)
        assert done.returncode == 2
        (line,) = done.stderr.splitlines()
        assert line.endswith('is not installed: it comes with the extra pipeline, pip install "hypernode[pipeline]"')


def test_a_folder_is_looked_at_without_the_pipeline(bare, tmp_path):
    from hypernode.stages import practice

    practice.run(tmp_path / "pull", "clamped_y", 0.004, 0)
    done = bare.run("hypernode", "inspect", "pull", *SIZE, "--write-config", "pull.yaml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "it can be imported" in done.stdout and (tmp_path / "pull.yaml").is_file()
    drawn = bare.run("hypernode", "inspect", "pull", *SIZE, "--figure", cwd=tmp_path)
    assert drawn.returncode == 2 and "matplotlib is not installed" in drawn.stderr


def test_the_schemas_are_those_of_the_repository(bare):
    assert bare.run("hypernode", "schema", "config").stdout == (ROOT / "config/schema.json").read_text()
    assert bare.run("hypernode", "schema", "files").stdout == (ROOT / "docs/schema.md").read_text()


def test_a_commit_of_somebody_elses_repository_is_not_taken_for_ours(bare):
    code = "from hypernode.storage.records import source_state; print(source_state())"
    assert bare.python(code) == "{}\n"


def test_with_the_pipeline_a_folder_becomes_a_material(wheel, tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    with environment(tmp_path_factory.mktemp("whole")) as whole:
        whole.install(f"{wheel}[pipeline]")
        _identifies(whole, folder)


def _identifies(whole, folder):
    assert whole.run("hypernode", "practice", "pull", cwd=folder).returncode == 0
    (folder / "tiny.yaml").write_text(json.dumps({"methods": {"tiny": TINY}}))
    words = ("identify", "pull", *SIZE, "--method", "tiny", "--config", "tiny.yaml")
    done = whole.run("hypernode", *words, cwd=folder)
    assert done.returncode in (0, 1) and "written   results/pull/tiny/material.nc" in done.stdout, done.stderr[-4000:]
    code = "import hypernode; print(hypernode.load_material('results/pull/tiny/material.nc').units['stress'])"
    assert whole.python(code, cwd=folder) == "MPa\n"
    audit = whole.run("hypernode", "audit", "verify", cwd=folder)
    assert audit.returncode == 0, audit.stdout
