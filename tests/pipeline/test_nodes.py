"""Nodes of a cluster keep what they compile apart, and only the run itself shows that it goes on."""

from types import SimpleNamespace

import pytest

from hypernode.pipeline import nodes
from hypernode.pipeline.nodes import keep_compiled_by_machine, machine


@pytest.fixture
def cache(monkeypatch):
    def after(**workflow):
        keep_compiled_by_machine(SimpleNamespace(**workflow))
        return nodes.os.environ.get("HYPERNODE_CACHE")

    monkeypatch.setenv("HYPERNODE_CACHE", "")
    monkeypatch.delenv("HYPERNODE_CACHE")
    return after


def test_a_job_sent_here_keeps_what_it_compiles_for_this_machine_alone(cache):
    assert cache(remote_exec=True) == f".cache/{machine()}"


def test_a_job_that_was_not_sent_keeps_what_it_compiles_where_it_always_is(cache):
    assert cache(remote_exec=False) is None and cache() is None


def test_a_folder_that_is_given_has_the_last_word(cache, monkeypatch):
    monkeypatch.setenv("HYPERNODE_CACHE", "/scratch/me")
    assert cache(remote_exec=True) == "/scratch/me"


def test_two_machines_of_one_host_name_are_told_apart(monkeypatch, tmp_path):
    names = set()
    for boot in ("one", "two"):
        (tmp_path / boot).write_text(boot)
        monkeypatch.setattr(nodes, "_BOOT", tmp_path / boot)
        names.add(machine())
    assert len(names) == 2


def test_where_the_kernel_has_no_name_for_itself_the_folder_is_the_usual_one(cache, monkeypatch, tmp_path):
    monkeypatch.setattr(nodes, "_BOOT", tmp_path / "absent")
    assert cache(remote_exec=True) is None
