"""Who is at work shows by counting, whatever its machine, process or clock."""

import subprocess
import sys
import time

from hypernode import cli
from hypernode.pipeline import liveness
from hypernode.pipeline.liveness import at_work, shown_alive

# Twenty beats, since a busy machine is late.
BEAT, WATCH = 0.05, 1.0
WORKER = """
import sys, time
from pathlib import Path
from hypernode.pipeline.liveness import shown_alive
with shown_alive("training (case X)", Path(sys.argv[1]), 0.05):
    time.sleep(60)
"""


def test_who_works_counts_and_who_has_ended_leaves_nothing(tmp_path):
    with shown_alive("forward (case X)", tmp_path / "alive", BEAT), shown_alive("the run", tmp_path / "alive", BEAT):
        found = at_work(tmp_path / "alive", WATCH)
    assert [each.partition(" on ")[0] for each in found] == ["forward (case X)", "the run"]
    assert not list((tmp_path / "alive").iterdir())


def test_who_was_killed_counts_no_more_and_its_sign_is_taken_away(tmp_path):
    worker = subprocess.Popen([sys.executable, "-c", WORKER, str(tmp_path / "alive")])
    end = time.monotonic() + 10
    while not (seen := at_work(tmp_path / "alive", WATCH)) and time.monotonic() < end:
        time.sleep(0.05)
    worker.kill()
    worker.wait()
    assert seen and list((tmp_path / "alive").iterdir())
    assert at_work(tmp_path / "alive", WATCH) == []
    assert not list((tmp_path / "alive").iterdir())


def test_a_sign_is_whole_whenever_it_is_read(tmp_path):
    with shown_alive("forward (case X)", tmp_path, beat=1e-4):
        read = [text for _ in range(3000) for text in liveness._counts(tmp_path).values()]
    assert len(set(read)) > 3, "the sign has to change while it is read"
    assert all(text.startswith("forward (case X) on ") and text.endswith("\n") for text in read)


def test_outside_a_run_no_sign_is_left_and_nobody_waits(tmp_path):
    with shown_alive("practice", tmp_path / "absent" / "alive", BEAT):
        time.sleep(2 * BEAT)
    begun = time.monotonic()
    assert at_work(tmp_path / "absent" / "alive") == []
    assert time.monotonic() - begun < 1 and not list(tmp_path.iterdir())


def test_a_folder_with_someone_at_work_is_not_idle(tmp_path, monkeypatch, capsys):
    (tmp_path / ".snakemake").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(liveness.at_work, "__defaults__", (liveness.FOLDER, WATCH))
    with shown_alive("forward (case X)", beat=BEAT):
        assert cli.main(["idle"]) == 1
    assert "1 at work in this folder (forward (case X)" in capsys.readouterr().err
    assert cli.main(["idle"]) == 0
