"""The profile of a run: every processor second in one rule and one part."""

import json

from benchmarks.run_profile import by_rule, draw, job_rows, main


def finished(results, name, seconds, log=""):
    for folder, ending, text in (
        ("benchmarks", ".jsonl", json.dumps({"cpu_time": seconds, "s": 9.0}) + "\n"),
        ("logs", ".log", log),
    ):
        path = (results / folder / name).with_suffix(ending)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def test_seconds_are_of_the_processor_in_the_shares_of_the_clock(tmp_path):
    finished(tmp_path, "X/paper/training", 30.0, "seconds of this job: tracing 5.00, compilation 10.00, rest 45.00\n")
    finished(tmp_path, "P/paper/training", 10.0)
    finished(tmp_path, "figures/one", 2.0)
    finished(tmp_path, "figures/two", "NA")
    training, figure = by_rule(job_rows(tmp_path))
    assert (training["rule"], training["jobs"], training["processor"]) == ("training", 2, 40.0)
    assert [training[part] for part in ("tracing", "compilation", "rest", "not told")] == [2.5, 5.0, 22.5, 10.0]
    assert (training["largest"], training["of"]) == (30.0, "X/paper")
    assert (figure["rule"], figure["jobs"], figure["processor"], figure["of"]) == ("figure", 2, 2.0, "one")


def test_the_bars_of_a_rule_add_up_to_its_processor_time(tmp_path):
    finished(tmp_path, "X/paper/training", 30.0, "seconds of this job: tracing 5.00, compilation 10.00, rest 45.00\n")
    (axes,) = draw(by_rule(job_rows(tmp_path))).axes
    assert sum(bar.get_width() for bar in axes.patches) == 30.0


def test_table_and_figure_lie_beside_the_records(tmp_path, capsys):
    finished(tmp_path, "X/paper/training", 30.0)
    main(str(tmp_path))
    assert {path.suffix for path in (tmp_path / "benchmarks").glob("profile.*")} >= {".csv", ".md", ".pdf", ".png"}
    assert "training" in capsys.readouterr().out
