"""The numbers of docs/paper.md, from a run: ``python -m docs.generator.paper [RESULTS]`` writes its tables anew."""

import re
import sys
from collections.abc import Callable
from pathlib import Path

from hypernode.config.loading import load_config
from hypernode.config.model import Config
from hypernode.pipeline.shown import matching_runs
from hypernode.tables.runs import read_runs, run_table
from hypernode.tables.writing import markdown_text

ROOT = Path(__file__).resolve().parents[2]
#: A table of the page: name and configuration, then what was rendered last.
BLOCK = re.compile(r"<!-- table (?P<name>\w+) of (?P<file>\S+) -->\n(?P<body>.*?)<!-- end of table -->", re.DOTALL)


def rendered(page: str, results: Path, load: Callable[[str], Config]) -> str:
    """The page with its tables as a results folder has them; what was not run is said below each.

    Args:
        page: text in Markdown, with tables between ``<!-- table NAME of FILE -->`` and ``<!-- end of table -->``.
        results: a results folder; runs that it lacks are named as not run.
        load: file of a configuration -> configuration.

    Raises:
        ValueError: a configuration has no such table of runs.
    """

    def block(match: re.Match) -> str:
        text = table_text(load(match["file"]), match["name"], results)
        return f"<!-- table {match['name']} of {match['file']} -->\n\n{text}\n<!-- end of table -->"

    return BLOCK.sub(block, page)


def table_text(config: Config, name: str, results: Path) -> str:
    """One table of runs in Markdown, and a sentence with those that a results folder lacks."""
    table = config.tables.get(name)
    if table is None or table.kind != "runs" or table.groups:
        raise ValueError(f"tables.{name}: no table of single runs; name one of kind 'runs' without groups")
    runs = matching_runs(config, table.runs, config.cases)
    files = {run: results / "/".join(run) / "evaluation.nc" for run in runs}
    present = [str(file) for file in files.values() if file.is_file()]
    parts = [markdown_text(run_table(read_runs(present), table.kind, table.columns))] if present else []
    absent = [run for run, file in files.items() if not file.is_file()]
    if absent:
        parts.append(" ".join(f"Not run: {each}." for each in _named(absent, runs)) + "\n")
    return "\n".join(parts)


def _named(absent: list[tuple[str, str]], runs: list[tuple[str, str]]) -> list[str]:
    """Runs by their cases; of a case of which nothing was run, how many."""
    cases = {case: [method for of, method in absent if of == case] for case, _ in absent}
    whole = {case: sum(of == case for of, _ in runs) for case in cases}
    return [
        f"`{case}`, all {len(methods)}"
        if len(methods) == whole[case]
        else f"`{case}`: {', '.join(f'`{each}`' for each in methods)}"
        for case, methods in cases.items()
    ]


if __name__ == "__main__":
    path = ROOT / "docs" / "paper.md"
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "results"
    text = rendered(path.read_text(encoding="utf-8"), folder, lambda file: load_config(ROOT / file))
    path.write_text(text, encoding="utf-8")
