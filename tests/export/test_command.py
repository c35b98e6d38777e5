"""``hypernode export`` writes what is asked for, where it is asked to, and overwrites nothing."""

import numpy as np
import pytest

from hypernode import cli
from tests.export.runs import MU, PHASE, write_run


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return write_run(tmp_path_factory.mktemp("results"))


def names(folder):
    return {path.name for path in folder.iterdir()}


def test_everything_is_written_where_nothing_is_said(run, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["export", str(run)]) == 0
    wanted = {"material.py", "material.npz", "sheet.vtu", "sheet.md", "sheet.feb", "laws.md", "laws.csv"}
    assert names(tmp_path / "skin_hypernode") == wanted
    assert {line.removeprefix("skin_hypernode/") for line in capsys.readouterr().out.split()} == wanted


def test_one_kind_is_added_to_a_folder_and_nothing_overwritten(run, tmp_path, capsys):
    for words in ([str(tmp_path / "out"), "--to", "numpy"], ["--to", "vtu", "--output", str(tmp_path / "out")]):
        assert cli.main(["export", str(run), *words]) == 0
    assert names(tmp_path / "out") == {"material.py", "material.npz", "sheet.vtu", "sheet.md"}
    before = {path: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    assert cli.main(["export", str(run), str(tmp_path / "out"), "--to", "numpy"]) == 2
    assert "material.py, " in capsys.readouterr().err
    assert {path: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before


def test_a_file_of_a_material_goes_to_numpy_alone(run, tmp_path, capsys):
    assert cli.main(["export", str(run / "constrained.nc"), str(tmp_path / "out")]) == 0
    assert names(tmp_path / "out") == {"material.py", "material.npz"}
    with np.load(tmp_path / "out" / "material.npz") as data:
        np.testing.assert_allclose(data["c"][0], 0.5 * MU[PHASE], rtol=1e-12)
    assert cli.main(["export", str(run / "constrained.nc"), str(tmp_path / "other"), "--to", "vtu"]) == 2
    assert cli.main(["export", str(run / "gradient.nc"), str(tmp_path / "other")]) == 2
    assert "gradient.nc: holds no material" in capsys.readouterr().err
    assert not (tmp_path / "other").exists()


def test_a_run_without_an_evaluation_is_named(run, tmp_path, capsys):
    assert cli.main(["export", str(run.parent), str(tmp_path / "out")]) == 2
    assert "no such file" in capsys.readouterr().err
    assert cli.main(["export", str(run), str(tmp_path / "a"), "--output", str(tmp_path / "b")]) == 2
    assert "the folder is given twice" in capsys.readouterr().err
