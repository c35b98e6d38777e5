"""Verdicts as they are printed."""

from hypernode.tables.verdicts import RunVerdict


def test_that_a_run_did_not_converge_is_said_before_what_is_worse():
    criteria = (
        {"name": "convergence", "level": "warn", "sentence": "It did not converge."},
        {"name": "law", "level": "warn", "sentence": "No law follows."},
        {"name": "forces", "level": "fail", "sentence": "Forces are missed."},
    )
    sentences = RunVerdict("a/b", "fail", criteria).sentences
    assert sentences == ["It did not converge.", "Forces are missed.", "No law follows."]
