"""Every number leads back to its inputs, and two runs are told apart where they first differ."""

from hypernode.cli import main
from hypernode.storage.differences import compare
from hypernode.storage.environment import versions
from hypernode.storage.lineage import lineage
from hypernode.storage.records import record_of, result_files, sha256
from tests.storage.conftest import stored


def test_explain_reaches_seeds_versions_code_and_raw_input_of_every_ancestor(results, raw, capsys):
    assert main(["audit", "explain", str(results / "c/m/material.nc")]) == 0
    text = capsys.readouterr().out
    numpy = f"numpy {versions()['numpy']}"
    for wanted in ("gradient.nc", "measurement.nc", "raw.csv", "seed = 3", numpy, "weight", "code 000000000000"):
        assert wanted in text
    node = lineage(results / "c/m/material.nc")
    assert node["parents"][0]["parents"][0]["raw_inputs"] == {raw.name: sha256(raw)}
    assert main(["audit", "explain", str(results / "nothing.nc")]) == 2
    assert "no such file" in capsys.readouterr().err


def test_diff_names_the_first_stage_that_differs_and_by_how_much(results, tmp_path, capsys):
    other = tmp_path / "other"
    for path in result_files(results):
        (other / path.relative_to(results)).parent.mkdir(parents=True, exist_ok=True)
        for each in (path, record_of(path)):
            (other / each.relative_to(results)).write_bytes(each.read_bytes())
    assert compare(results, other) == [] and main(["audit", "diff", str(results), str(other)]) == 0
    changed = {"compiler": {"XLA_FLAGS": "--xla_other=true"}}
    stored(other / "c/m/gradient.nc", 1.5, [other / "c/measurement.nc"], "gradient", changed, weight=0.1)
    stored(other / "c/m/material.nc", 2.0, [other / "c/m/gradient.nc"], weight=0.5)
    entries = compare(results, other)
    assert [entry["file"] for entry in entries] == ["c/m/gradient.nc", "c/m/material.nc"]
    first = entries[0]["differences"]
    assert "configuration: weight = None against 0.1" in first
    assert any(line.startswith("compiler: XLA_FLAGS = ") for line in first)
    assert any("loss: largest difference 0.5, 0.5 of" in line for line in first)
    assert "input gradient.nc differs" in entries[1]["differences"]
    assert main(["audit", "diff", str(results), str(other)]) == 1
    assert "gradient.nc" in capsys.readouterr().out
