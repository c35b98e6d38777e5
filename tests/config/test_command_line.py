"""Later files and ``--config`` are laid over what comes before, and an error says which of them gave the value."""

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml

from hypernode.config.command_line import run_config
from hypernode.config.errors import ConfigError
from hypernode.config.loading import load_config
from tests.config.test_config import BASE

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def files(tmp_path):
    (tmp_path / "first.yaml").write_text(yaml.safe_dump(BASE))
    (tmp_path / "second.yaml").write_text("methods:\n  m:\n    seed: 3\n    node: {hidden: [6]}\n")
    return tmp_path / "first.yaml", tmp_path / "second.yaml"


def workflow(*files, **overrides):
    return SimpleNamespace(config_settings=SimpleNamespace(configfiles=files, config=overrides))


def test_a_later_file_changes_what_it_says_and_nothing_else(files):
    method = load_config(*files).methods["m"]
    assert (method.seed, method.node.hidden, method.node.terms) == (3, [6], ["I1"])


def test_an_error_names_the_file_that_gave_the_value(files):
    first, second = files
    second.write_text("methods:\n  m:\n    seed: -3\nnoise: {low: {sigma: 1.0}}\n")
    with pytest.raises(ConfigError, match=r"second\.yaml:3: methods\.m\.seed = -3"):
        load_config(first, second)
    with pytest.raises(ConfigError, match=r"first\.yaml:\d+: methods\.m\.seed = 'x'"):
        first.write_text(yaml.safe_dump(BASE | {"methods": {"m": {**BASE["methods"]["m"], "seed": "x"}}}))
        load_config(first)
    with pytest.raises(ConfigError, match=r"^--config: methods\.m\.seed = '-4'"):
        load_config(first, overrides={"methods": {"m": {"seed": "-4"}}})


def test_files_of_the_command_line_replace_the_default_and_config_alone_does_not(files):
    default, other = files
    other.write_text(yaml.safe_dump(BASE | {"cases": {"b": BASE["cases"]["a"]}}))
    assert set(run_config(workflow(other), {}, default).cases) == {"b"}
    config = run_config(workflow(noise={"low": {"sigma": "0.5"}}), {}, default)
    assert set(config.cases) == {"a"} and config.noise["low"].sigma == 0.5 and config.noise["high"].sigma == 1e-3


def test_numbers_and_null_may_be_text_as_snakemake_leaves_them(files):
    overrides = {"materials": {"soft": {"mu": "3.5"}}, "methods": {"x": {"extends": "paper", "interpolant": "null"}}}
    config = run_config(workflow(**overrides), {}, files[0])
    assert config.materials["soft"].parameters == {"mu": 3.5} and config.methods["x"].interpolant is None


def test_without_the_objects_of_this_version_the_public_configuration_counts(files):
    assert set(run_config(SimpleNamespace(), {}, files[0]).cases) == {"a"}
    merged = BASE | {"cases": {"b": BASE["cases"]["a"]}}
    assert set(run_config(SimpleNamespace(), merged, files[0]).cases) == {"b"}


def test_snakemake_plans_what_two_files_and_config_say_together(tmp_path, files):
    line = [sys.executable, "-m", "snakemake", "--dry-run", "--cores", "1", "--snakefile", str(ROOT / "Snakefile")]
    line += ["--profile", str(ROOT / "profiles/default"), "--directory", str(tmp_path)]
    line += ["--configfile", str(ROOT / "config/smoke.yaml"), "second.yaml"]
    case = "{geometry: disc, inclusion: stiff, matrix: soft, loads: [uniaxial_x], methods: [other]}"
    line += ["--config", f"cases={{b: {case}}}"]
    files[1].write_text("methods: {other: {extends: tiny, seed: 5}}\n")
    plan = subprocess.run(line, capture_output=True, text=True, cwd=tmp_path)
    assert plan.returncode == 0, plan.stderr[-2000:]
    assert "results/b/other/material.nc" in plan.stdout and "results/disc/tiny/material.nc" in plan.stdout
    files[1].write_text("methods:\n  other: {extends: tiny, seed: five}\n")
    refused = subprocess.run(line, capture_output=True, text=True, cwd=tmp_path)
    assert refused.returncode != 0 and "second.yaml:2: methods.other.seed = 'five'" in refused.stderr
    assert "Traceback" not in refused.stderr
