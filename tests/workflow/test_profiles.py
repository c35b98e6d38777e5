"""A cluster runs the workflow as one machine does."""

import re
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]
DEFAULT, CLUSTER = (
    yaml.safe_load((ROOT / f"profiles/{name}/profile.yaml").read_text()) for name in ("default", "cluster")
)


def test_a_cluster_reruns_for_the_same_reasons_as_one_machine():
    assert CLUSTER == {**CLUSTER, **DEFAULT}


def test_a_cluster_is_told_what_every_rule_declares():
    asked = set(re.findall(r"{(?:resources\.)?(\w+)}", CLUSTER["cluster-generic-submit-cmd"]))
    assert asked == {"rule", "threads", "mem_mb", "runtime"}
    # The crate is made where Snakemake runs.
    for file in set(ROOT.glob("workflow/rules/*.smk")) - {ROOT / "workflow/rules/crate.smk"}:
        text = file.read_text()
        rules = len(re.findall(r"(?m)^rule ", text))
        for word in ("threads: 1", "mem_mb=memory(CONFIG, ", "runtime=runtime(CONFIG, "):
            assert text.count(word) == rules, (file.name, word)
