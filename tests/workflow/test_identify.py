"""The command identify takes a folder to a material, its figure and a verdict, by the project's own workflow."""

import pytest
import yaml

from hypernode import cli, load_material
from tests.inspection.folders import FIELDS, SIZE, write_frames, write_record
from tests.workflow.running import COMPILED

#: A method of seconds, of which nothing is expected but an end.
TINY = {
    "interpolant": {"features": 2, "frequency_scale": 1, "widths": [2], "iterations": 1},
    "node": {"terms": ["I1"], "hidden": [2]},
    "hypernetwork": {"features": 2, "frequency_scale": 1, "widths": [2]},
    **{stage: {"iterations": 1} for stage in ("homogenised", "initialisation", "pretraining", "training")},
}


@pytest.mark.slow
def test_a_folder_becomes_a_material_with_a_verdict(request, tmp_path, monkeypatch, capfd):
    if not request.config.getoption("--smoke"):
        pytest.skip("whole workflows run with --smoke")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HYPERNODE_CACHE", str(COMPILED))
    write_frames(tmp_path / "pull", FIELDS["clamped_y"])
    write_record(tmp_path / "pull")
    (tmp_path / "tiny.yaml").write_text(yaml.safe_dump({"methods": {"tiny": TINY}}))
    words = ["--size", *map(str, SIZE), "--frame-rate", "1", "--method", "tiny", "--config", "tiny.yaml"]
    code = cli.main(["identify", "pull", *words])
    out, err = capfd.readouterr()
    lines = out.splitlines()
    (verdict,) = [line for line in lines if line.endswith("  pull/tiny")]
    assert code == (1 if verdict.startswith("fail") else 0), err[-4000:]
    assert lines[lines.index(verdict) + 1].strip().startswith(verdict.split()[0] + ":")
    files = [line.removeprefix("written   ") for line in lines if line.startswith("written")]
    figures = [f"results/figures/pull_tiny.{kind}" for kind in ("pdf", "png")]
    assert files == ["pull.yaml", "results/pull/tiny/material.nc", *figures, "results/pull/tiny/explorer.html"]
    assert all((tmp_path / file).is_file() for file in files)
    assert load_material("results/pull/tiny/material.nc").units["stress"] == "MPa"
    assert "steps (100%) done" in err and "SNAKEMAKE" not in out
    assert cli.main(["audit", "verify"]) == 0
