"""What is said of progress can be turned up, turned down and listened to."""

import logging
import os

import pytest

from hypernode import cli, progress


@pytest.fixture
def level(monkeypatch):
    """Sets the level as the variable does; the usual one is back afterwards."""

    def named(name):
        monkeypatch.setenv(progress.LEVEL, name)
        progress.set_level()

    yield named
    progress.LOG.setLevel(logging.INFO)


def steps():
    counted = progress.Progress("stage", "case", 3, every=3600.0)
    counted.last = counted.start
    for _ in range(3):
        counted.advance(loss=0.5)


@pytest.mark.parametrize(("name", "shown"), [("debug", [1, 2, 3]), ("info", [3]), ("warning", []), ("loud", [3])])
def test_the_level_decides_which_steps_are_shown(name, shown, level, capsys):
    level(name)
    steps()
    lines = capsys.readouterr().err.splitlines()
    assert [line.split(",")[0] for line in lines] == [f"[stage] case: step {step}/3" for step in shown]


@pytest.mark.parametrize(("numbers", "shown"), [({}, ""), ({"loss": 0.5, "kept": 2.0}, ", loss 0.5, kept 2")])
def test_a_step_shows_the_numbers_that_it_has(numbers, shown, level, capsys):
    level("info")
    progress.Progress("stage", "case", 1).advance(**numbers)
    assert capsys.readouterr().err == f"[stage] case: step 1/1{shown}, 0 s left\n"


def test_what_is_said_is_heard_at_any_level_and_not_shown(level, capsys):
    level("warning")
    with progress.heard() as texts:
        progress.say("import", "a", "4 % of it")
    progress.say("import", "a", "not shown")
    assert texts == ["4 % of it"] and capsys.readouterr().err == ""


def test_a_listener_of_logging_hears_it_as_a_record(level):
    level("info")
    seen = []

    class Listener(logging.Handler):
        def emit(self, record):
            seen.append((record.levelname, record.getMessage()))

    listener = Listener()
    logging.getLogger("hypernode").addHandler(listener)
    try:
        progress.say("import", "a", "read")
    finally:
        logging.getLogger("hypernode").removeHandler(listener)
    assert seen == [("INFO", "[import] a: read")]


def test_the_command_line_hands_the_level_to_its_jobs(level, monkeypatch, tmp_path):
    level("info")
    monkeypatch.chdir(tmp_path)
    assert cli.main(["--log", "warning", "idle"]) == 0
    assert os.environ[progress.LEVEL] == "warning" and not progress.LOG.isEnabledFor(logging.INFO)
