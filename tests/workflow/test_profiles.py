"""A cluster runs the workflow as one machine does."""

import re
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
DEFAULT, GENERIC, SLURM = (
    yaml.safe_load((ROOT / f"profiles/{name}/profile.yaml").read_text())
    for name in ("default", "cluster-generic", "slurm")
)


@pytest.mark.parametrize("cluster", [GENERIC, SLURM])
def test_a_cluster_reruns_for_the_same_reasons_as_one_machine_and_tries_again_with_more(cluster):
    assert cluster == {**cluster, **DEFAULT}
    assert cluster["retries"] > 0 and cluster["latency-wait"] > 30


def test_a_cluster_is_told_what_every_rule_declares():
    asked = set(re.findall(r"{(?:resources\.)?(\w+)}", GENERIC["cluster-generic-submit-cmd"]))
    assert asked == {"rule", "threads", "mem_mb", "runtime"}
    # The crate is made where Snakemake runs.
    for file in set(ROOT.glob("workflow/rules/*.smk")) - {ROOT / "workflow/rules/crate.smk"}:
        text = file.read_text()
        rules = len(re.findall(r"(?m)^rule ", text))
        measured = r"=(?:{0}\(CONFIG, |for_batch\(POPULATIONS, \"{0}\")"
        for word in ("threads: 1", "mem_mb" + measured.format("memory"), "runtime" + measured.format("runtime")):
            assert len(re.findall(word, text)) == rules, (file.name, word)
