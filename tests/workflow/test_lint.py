"""Snakemake's own advice on the workflow, all of it but one (docs/decisions/0028)."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: One environment serves every rule, from requirements.txt and requirements/constraints.txt.
DECLINED = "Specify a conda environment or container for each rule.:"


def test_snakemake_has_nothing_to_say_but_that_no_rule_has_an_environment_of_its_own():
    line = [sys.executable, "-m", "snakemake", "--lint", "--configfile", str(ROOT / "config/smoke.yaml")]
    done = subprocess.run([*line, "--snakefile", str(ROOT / "Snakefile")], capture_output=True, text=True, cwd=ROOT)
    said = [words[2:] for words in map(str.strip, done.stderr.splitlines()) if words.startswith("* ")]
    assert DECLINED in said, done.stderr
    assert [advice for advice in said if advice != DECLINED] == []
