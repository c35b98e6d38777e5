"""The commands inspect and identify, as they are called: what they print, write and refuse."""

import subprocess
import sys

import pytest

from hypernode import cli
from hypernode.commands import identify
from tests.inspection.folders import FIELDS, SIZE, strict, write_frames, write_record

WORDS = ["--size", *map(str, SIZE), "--frame-rate", "1"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_frames(tmp_path / "pull", FIELDS["clamped_y"])
    write_record(tmp_path / "pull")
    return tmp_path / "pull"


def test_inspect_prints_what_it_found_and_fails_where_something_is_missing(folder, capsys):
    assert cli.main(["inspect", "pull"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[1] for line in lines if line.startswith("missing")] == ["width:", "pixel_size:", "frame_rate:"]
    assert cli.main(["inspect", "pull", *WORDS]) == 0
    text = capsys.readouterr().out
    for part in ("y downward", "13 x 12 points", "looks like clamped_y", "61 samples, 0 to 3 s", "frame 4 at 1.120"):
        assert part in text
    assert text.splitlines()[-1].endswith("it can be imported")
    assert max(map(len, text.splitlines())) <= 120


@pytest.mark.parametrize("words", [[], WORDS])
def test_json_is_strict_and_says_the_same(folder, words, capsys):
    def hole(number, rows):
        return rows if number == 1 else rows[26:]

    write_frames(folder, FIELDS["clamped_y"], change=hole)
    code = cli.main(["inspect", "pull", "--json", *words, "--set", "edge_ring=2"])
    said = strict(capsys.readouterr().out)
    assert said["importable"] is (code == 0) and (code == 0) is bool(words)
    assert said["load"]["kind"] == "clamped_y" and said["specimen"]["edge_ring"] == 2
    assert said["frames"]["lost"][-1] == {"frame": 4, "outline": 26, "inside": 0}
    assert [each["key"] for each in said["missing"]] == ([] if words else ["width", "pixel_size", "frame_rate"])
    assert [each["frame"] for each in said["steps"]] == ([2, 3, 4] if words else [])


def test_a_mean_that_nothing_tells_is_null(folder, capsys):
    write_frames(folder, FIELDS["clamped_y"], change=lambda number, rows: rows if number == 1 else rows[26:])
    assert cli.main(["inspect", "pull", "--json"]) == 1
    assert strict(capsys.readouterr().out)["load"]["mean_gradient"][-1][1][1] is None


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (["nowhere"], "nowhere: no such folder"),
        (["pull", "--set", "edge_ring"], "write KEY=VALUE"),
        (["pull", "--set", "load=shear", "--load", "shear"], "load is given twice"),
        (["pull", "--set", "tests=[]"], "written into a configuration"),
        (["pull", "--set", "frames=[1"], "the value is not YAML"),
        (["pull", "--set", "lod=shear"], "did you mean 'load'"),
        (["pull", "--load", "clamped"], "did you mean 'clamped_y'"),
        (["pull", "--figure", "a.svg"], "ends in .pdf or .png"),
        (["pull", "--figure", "pull/a.png"], "measurements stay as they are"),
        (["pull", "--write-config", "pull/a.yaml"], "measurements stay as they are"),
    ],
)
def test_what_cannot_be_meant_is_one_line_and_exit_code_2(folder, words, why, capsys):
    before = sorted(folder.iterdir())
    assert cli.main(["inspect", *words]) == 2
    out, err = capsys.readouterr()
    assert why in err and not out and "Traceback" not in err
    assert sorted(folder.iterdir()) == before


def test_figure_and_configuration_are_written_beside_and_not_into_the_folder(folder, tmp_path, capsys):
    before = sorted(folder.iterdir())
    assert cli.main(["inspect", "pull", *WORDS, "--figure", "--write-config", "pull.yaml"]) == 0
    written = ["inspect_pull.pdf", "inspect_pull.png", "pull.yaml"]
    assert [line.split()[1] for line in capsys.readouterr().out.splitlines() if line.startswith("written")] == written
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*written, "pull"])
    assert (tmp_path / "inspect_pull.png").stat().st_size > 10_000
    assert sorted(folder.iterdir()) == before


def test_a_configuration_that_would_lack_something_is_not_written(folder, tmp_path, capsys):
    assert cli.main(["inspect", "pull", "--write-config", "pull.yaml"]) == 1
    assert "pull.yaml is not written" in capsys.readouterr().err and not (tmp_path / "pull.yaml").exists()


def test_pictures_alone_have_no_figure(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pictures").mkdir()
    for number in range(2):
        (tmp_path / "pictures" / f"{number}.jpg").write_bytes(b"")
    assert cli.main(["inspect", "pictures", "--figure", "a.png"]) == 1
    out, err = capsys.readouterr()
    assert "no displacement files" in out.replace("\n          ", " ") and "a.png is not written" in err
    assert not (tmp_path / "a.png").exists()


def test_inspecting_and_drawing_need_no_jax(folder):
    code = "import sys; from hypernode import cli; cli.main(sys.argv[1:]); sys.exit('jax' in sys.modules)"
    words = ["inspect", "pull", *WORDS, "--figure", "a.png", "--write-config", "a.yaml"]
    done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_identify_refuses_what_cannot_be_imported_before_it_writes_or_runs(folder, tmp_path, capsys):
    assert cli.main(["identify", "pull"]) == 2
    assert "missing   frame_rate" in capsys.readouterr().out
    assert cli.main(["identify", "pull", *WORDS, "--method", "hypernod"]) == 2
    assert "did you mean 'hypernode'" in capsys.readouterr().err
    assert cli.main(["identify", "pull", *WORDS, "--cores", "0"]) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["pull"]


@pytest.mark.parametrize("command", ["inspect", "identify"])
def test_names_with_braces_are_refused_by_both_commands_alike(command, folder, capsys):
    named = folder.rename(folder.parent / "pull{1}")
    assert cli.main([command, str(named), *WORDS]) == {"inspect": 1, "identify": 2}[command]
    said = " ".join(capsys.readouterr().out.split())
    assert "cannot name a file with braces" in said and "it cannot be imported yet" in said


def test_an_installation_without_its_workflow_says_so(folder, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(identify, "project_folder", lambda: None)
    assert cli.main(["identify", "pull", *WORDS]) == 2
    assert "install the project again" in capsys.readouterr().err
    monkeypatch.setattr(identify.importlib.util, "find_spec", lambda name: None)
    assert cli.main(["identify", "pull", *WORDS]) == 2
    assert capsys.readouterr().err == (
        'error: snakemake is not installed: it comes with the extra pipeline, pip install "hypernode[pipeline]"\n'
    )
