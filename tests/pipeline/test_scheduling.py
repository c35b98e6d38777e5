"""Jobs side by side declare no more memory than there is, and nothing fails in a Snakemake of another make."""

import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

from hypernode.pipeline.scheduling import SHARE, lift_rate_limit, limit_memory, machine_memory

ROOT = Path(__file__).resolve().parents[2]
#: Of six jobs that each declare two fifths of the memory, two fit side by side; one declares ten times all there is.
SNAKEFILE = """
from hypernode.pipeline.scheduling import lift_rate_limit, limit_memory, machine_memory
limit_memory(workflow)
onstart:
    lift_rate_limit(workflow)
    print("limiter:", workflow.scheduler.job_rate_limiter)
rule all:
    input: [f"{k}.txt" for k in range(6)], "huge.txt"
rule one:
    output: "{k}.txt"
    wildcard_constraints: k=r"\\d"
    resources: mem_mb=int(0.4 * machine_memory())
    shell: "date +%s.%N > {output}; sleep 0.4; date +%s.%N >> {output}"
rule huge:
    output: "huge.txt"
    resources: mem_mb=10 * machine_memory()
    shell: "date +%s.%N > {output}; sleep 0.4; date +%s.%N >> {output}"
"""


def test_with_more_cores_than_memory_no_more_jobs_run_than_fit_and_one_too_large_runs_alone(tmp_path):
    (tmp_path / "Snakefile").write_text(SNAKEFILE)
    line = [sys.executable, "-m", "snakemake", "--cores", "32", "--quiet", "all"]
    done = subprocess.run(line, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert "limiter: None" in done.stdout
    spans = {file.stem: tuple(map(float, file.read_text().split())) for file in tmp_path.glob("*.txt")}
    assert len(spans) == 7
    together = {name: sum(a <= begun < b for a, b in spans.values()) for name, (begun, _) in spans.items()}
    assert max(together.values()) == 2
    begun, ended = spans.pop("huge")
    assert all(b <= begun or a >= ended for a, b in spans.values())


def fake(**changed):
    """A workflow that keeps what is registered with it."""
    workflow = SimpleNamespace(is_main_process=True, nodes=None, global_resources={})
    workflow.register_resource = workflow.global_resources.__setitem__
    vars(workflow).update(changed)
    return workflow


def test_what_the_user_says_a_cluster_and_a_job_of_its_own_are_not_limited():
    here = fake()
    limit_memory(here)
    assert here.global_resources == {"mem_mb": int(SHARE * machine_memory())}
    for workflow in (fake(nodes=100), fake(is_main_process=False)):
        limit_memory(workflow)
        assert workflow.global_resources == {}
    said = fake(global_resources={"mem_mb": 500})
    said.register_resource = said.global_resources.__setitem__
    limit_memory(said)
    assert said.global_resources == {"mem_mb": 500}


def test_a_snakemake_that_lacks_what_is_asked_of_it_goes_on_without():
    empty = SimpleNamespace()
    limit_memory(empty)
    lift_rate_limit(empty)
    lift_rate_limit(SimpleNamespace(scheduler=SimpleNamespace(), local_exec=True))
    assert vars(empty) == {}


def test_submissions_to_a_cluster_stay_limited():
    for local, left in ((True, None), (False, "a limit")):
        scheduler = SimpleNamespace(job_rate_limiter="a limit")
        lift_rate_limit(SimpleNamespace(scheduler=scheduler, local_exec=local))
        assert scheduler.job_rate_limiter == left


def test_what_others_wait_for_begins_first():
    text = "\n".join(path.read_text() for path in sorted((ROOT / "workflow" / "rules").glob("*.smk")))
    found = {
        rule: int(number) for rule, number in re.findall(r"^rule (\w+):\n(?:.+\n)*?    priority: (\d+)", text, re.M)
    }
    order = (("true_material", "forward", "measurement", "import_dic"), ("constrained",), ("pretraining", "training"))
    sheets, fields, networks = ({found[rule] for rule in rules} for rules in order)
    assert min(sheets) > max(fields) > max(networks) > 0
    assert not {"evaluation", "figure", "table"} & set(found)
