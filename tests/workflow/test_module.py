"""Another workflow takes the project's in as a module."""

import subprocess
import sys

from hypernode.storage.audit import verify
from tests.workflow.running import ROOT

MODULE = """
module hypernode:
    snakefile: "{root}/workflow/Snakefile"
    config: config

use rule * from hypernode
"""


def test_a_module_plans_the_same_jobs_and_its_results_pass_the_audit(tmp_path):
    (tmp_path / "Snakefile").write_text(MODULE.format(root=ROOT))
    line = [sys.executable, "-m", "snakemake", "--cores", "2", "--configfile", str(ROOT / "config/smoke.yaml")]
    plan = subprocess.run([*line, "--dry-run"], cwd=tmp_path, capture_output=True, text=True)
    assert plan.returncode == 0, plan.stderr[-3000:]
    assert "results/tables/summary.csv" in plan.stdout and "results/seen/updating/explorer.html" in plan.stdout
    done = subprocess.run([*line, "--", "results/seen/true_material.nc"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-3000:]
    assert (tmp_path / "results/seen/true_material.nc.json").is_file()
    assert [found for found in verify(tmp_path / "results") if not found.notice] == []
