"""What a second run does: what changed, what is gone and what is damaged, and no more."""

import json
import os
import shutil
import subprocess
import sys

import pytest
import yaml

from hypernode.storage.audit import verify
from hypernode.storage.netcdf import sha256
from hypernode.storage.provenance import code_hash, data_read, modules_used
from hypernode.storage.records import read_record, result_files
from tests.workflow.running import ROOT, copied, declared, snakemake


def test_a_record_that_is_gone_is_made_again(smoke, tmp_path):
    copy = copied(smoke, tmp_path / "copy")
    record = copy / "results/seen/homogeneous/evaluation.nc.json"
    record.unlink()
    (copy / "results/pierced/forward.nc.json").unlink()
    plan = snakemake(copy, "--dry-run").stdout
    assert {"results/pierced/forward.nc.json", str(record.relative_to(copy))} <= declared(plan, "output:")
    done = snakemake(copy, str(record.relative_to(copy)))
    assert done.returncode == 0, done.stderr[-3000:]
    assert read_record(record.with_suffix(""))["rule"] == "evaluation"


def test_a_second_run_has_nothing_to_do(smoke):
    """Beside the first: paths to the workflow are relative, and count as inputs of the crate."""
    assert "Nothing to be done" in snakemake(copied(smoke, smoke.with_name("again"))).stderr


def test_adding_a_case_runs_only_its_jobs(smoke, tmp_path):
    config = yaml.safe_load((ROOT / "config/smoke.yaml").read_text())
    config["cases"]["other"] = {**config["cases"]["disc"], "methods": ["tiny"]}
    (tmp_path / "more.yaml").write_text(yaml.safe_dump(config))
    plan = snakemake(smoke, "--dry-run", config=tmp_path / "more.yaml")
    assert plan.returncode == 0
    jobs = [line for line in plan.stdout.splitlines() if line.strip().startswith("output:")]
    shown = "/other/", "tables/", "ro-crate", "index.html"
    assert jobs and all(any(part in line for part in shown) for line in jobs)


def test_a_run_with_another_case_goes_to_its_end_over_the_results_of_the_first(smoke, tmp_path):
    copy = copied(smoke, tmp_path / "copy")
    config = yaml.safe_load((ROOT / "config/smoke.yaml").read_text())
    config["cases"]["other"] = {**config["cases"]["seen"], "methods": ["homogeneous"]}
    (tmp_path / "more.yaml").write_text(yaml.safe_dump(config))
    done = snakemake(copy, config=tmp_path / "more.yaml")
    assert done.returncode == 0, done.stderr[-4000:]
    assert verify(copy / "results") == []
    described = json.loads((copy / "results/ro-crate-metadata.json").read_text())["@graph"]
    assert any(each["@id"] == "other/homogeneous/evaluation.nc" for each in described)


def test_editing_one_method_stage_keeps_the_earlier_ones(smoke, tmp_path):
    config = yaml.safe_load((ROOT / "config/smoke.yaml").read_text())
    config["methods"]["tiny"]["training"] = {"equilibrium": "equilibrated", "iterations": 60}
    (tmp_path / "edited.yaml").write_text(yaml.safe_dump(config))
    full = snakemake(smoke, "--dry-run", config=tmp_path / "edited.yaml").stdout
    outputs = declared(full, "output:")
    assert "results/disc/tiny/material.nc" in outputs
    earlier = ("interpolant", "forward", "tiny_pointwise")
    assert not [o for o in outputs if any(name in o for name in earlier) and "definition" not in o]


def test_same_configuration_gives_the_same_bytes(smoke, tmp_path):
    """Compiled anew as well."""
    wanted = "results/disc/tiny/evaluation.nc", "results/figures/disc.pdf"
    again = snakemake(tmp_path, *wanted, compiled=tmp_path / ".cache")
    assert again.returncode == 0, again.stderr[-3000:]
    compared = list((tmp_path / "results").rglob("*.nc")) + list((tmp_path / "results").rglob("*.pdf"))
    assert len(compared) >= 11
    for path in compared:
        assert sha256(path) == sha256(smoke / path.relative_to(tmp_path)), path.name


def test_a_damaged_intermediate_stops_the_next_stage(smoke, tmp_path):
    copy = copied(smoke, tmp_path / "copy")
    damaged = copy / "results/disc/tiny/interpolant.nc"
    data = bytearray(damaged.read_bytes())
    data[len(data) // 2] ^= 4
    times = damaged.stat()
    damaged.write_bytes(bytes(data))
    # A flipped bit leaves the time of the file alone, so the workflow sees nothing to do upstream.
    os.utime(damaged, ns=(times.st_atime_ns, times.st_mtime_ns))
    (copy / "results/disc/tiny/evaluation.nc").unlink()
    failed = snakemake(copy, "results/disc/tiny/evaluation.nc")
    assert failed.returncode != 0 and "interpolant.nc" in failed.stderr
    assert not (copy / "results/disc/tiny/evaluation.nc").exists()


def test_the_code_hash_of_a_rule_covers_what_it_imports_and_no_more():
    scripts = ROOT / "workflow/scripts"
    names = {p.name for p in modules_used(scripts / "gradient.py")}
    assert {"gradient.py", "netcdf.py", "mesh.py"} <= names
    assert not {"neural_ode.py", "optimisation.py", "reading.py", "equilibrium_solver.py"} & names
    assert "neural_ode.py" in {p.name for p in modules_used(scripts / "training.py")}
    assert code_hash(scripts / "gradient.py") != code_hash(scripts / "training.py")


def test_the_code_hash_of_a_rule_covers_the_files_that_its_modules_bring_along():
    scripts = ROOT / "workflow/scripts"
    assert {"index.html", "style.css", "mechanics.js"} <= {
        p.name for p in data_read(modules_used(scripts / "explorer.py"))
    }
    assert data_read(modules_used(scripts / "evaluation.py")) == []


@pytest.mark.parametrize(
    ("module", "text"),
    [
        ("stages/interpolant.py", "def run("),
        ("figures/style.py", "def "),
        ("mechanics/convex_basis.py", "def _coefficient("),
    ],
)
def test_editing_one_function_reruns_exactly_the_rules_that_import_its_module(smoke, tmp_path, module, text):
    folder = tmp_path / "project"
    folder.mkdir()
    shutil.copy(ROOT / "Snakefile", folder)
    for part in ("workflow", "src", "config", "profiles"):
        shutil.copytree(ROOT / part, folder / part)
    edited = folder / "src/hypernode" / module
    code = edited.read_text()
    assert text in code
    edited.write_text(code.replace(text, f"def _unused():\n    return 0\n\n\n{text}", 1))
    line = [sys.executable, "-m", "snakemake", "--dry-run", "--snakefile", str(folder / "Snakefile"), "--cores", "1"]
    line += ["--profile", str(folder / "profiles/default"), "--directory", str(smoke)]
    line += ["--configfile", str(folder / "config/smoke.yaml")]
    environment = {**os.environ, "PYTHONPATH": str(folder / "src")}
    plan = subprocess.run(line, capture_output=True, text=True, cwd=folder, env=environment)
    assert plan.returncode == 0, plan.stderr[-2000:]
    changed, planned, rule = set(), set(), None
    for words in map(str.split, plan.stdout.splitlines()):
        if words[:1] in (["rule"], ["localrule"]):
            rule = words[1].rstrip(":")
            planned.add(rule)
        elif words[:1] == ["reason:"]:
            if "Params" in words or "Code" in words:
                changed.add(rule)
            else:
                assert "Input" in words, words
    scripts = (ROOT / "workflow/scripts").glob("*.py")
    importing = {script.stem for script in scripts if ROOT / "src/hypernode" / module in modules_used(script)}
    ran = {read_record(path)["rule"] for path in result_files(smoke / "results")}
    # Snakemake names one reason a job; what importing rules leave makes others run because of their input.
    assert changed and changed <= importing and importing & ran <= planned
