"""The study of the level: which scores count."""

import json

from benchmarks.level import __main__ as level
from benchmarks.strangers import running

SCORE = {
    **{"level": 1.0, "stated": 0.1, "within": True, "tested": 0.0, "refuted": 0.0, "verdict": "passed", "cpu_s": 1.0},
    "modes": {"shear": [0.02, 0.03]},
}


def test_a_score_with_other_keys_changed_is_run_again(tmp_path, monkeypatch):
    ran = []

    def run(command, **_):
        ran.append(json.loads(command[-1]))
        row = {"name": "sheet", "because": "", "changed": ran[-1], **SCORE}
        (tmp_path / "score.json").write_text(json.dumps(row))

    monkeypatch.setattr(running.subprocess, "run", run)
    for changed in ({}, {}, {"edge_ring": 1}, {"edge_ring": 1}, {}):
        assert level.row_of("seen", "sheet", tmp_path, changed)["changed"] == changed
    assert ran == [{}, {"edge_ring": 1}, {}]
