"""What is said before any job starts: of a wrong configuration, of absent data, of a sheet too large."""

import re

import pytest
import yaml

from hypernode.pipeline.scheduling import SHARE, machine_memory
from tests.workflow.running import ROOT, snakemake


def test_a_wrong_configuration_stops_before_any_job_without_traceback(tmp_path):
    text = (ROOT / "config/smoke.yaml").read_text().replace("radius: 0.25", "radus: 0.25")
    (tmp_path / "bad.yaml").write_text(text)
    failed = snakemake(tmp_path, config=tmp_path / "bad.yaml")
    assert failed.returncode != 0
    assert "did you mean 'radius'" in failed.stderr + failed.stdout
    assert "Traceback" not in failed.stderr + failed.stdout
    assert not (tmp_path / "results").exists()


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    """What is planned for a sheet that is too large for any machine, beside a specimen that is absent."""
    folder = tmp_path_factory.mktemp("plan")
    config = yaml.safe_load((ROOT / "config/smoke.yaml").read_text())
    config["cases"]["disc"]["cells"] = [3000, 3000]
    sizes = {"width": 1, "height": 1, "thickness": 1, "pixel_size": 1, "frame_rate": 1}
    config["specimens"] = {"s": {"folder": "nowhere", "optional": True, "published_at": "repository a/b", **sizes}}
    config["cases"]["real"] = {"specimen": "s", "methods": ["tiny"]}
    (folder / "c.yaml").write_text(yaml.safe_dump(config))
    planned = snakemake(folder, "--dry-run", config=folder / "c.yaml")
    assert planned.returncode == 0, planned.stderr[-2000:]
    return planned


def test_a_job_that_is_too_large_for_the_machine_asks_for_all_of_it(plan):
    asked = {int(value) for value in re.findall(r"mem_mb=(\d+)", plan.stdout)}
    assert max(asked) == int(SHARE * machine_memory()) and len(asked) > 10


def test_an_absent_specimen_is_left_out_in_one_line(plan):
    lines = [line for line in plan.stderr.splitlines() if "real" in line]
    assert lines == ["Leaving out real: there is no folder nowhere; its data are published in repository a/b"]
