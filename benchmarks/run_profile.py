"""Where the time of a run went: processor seconds by rule and by what its jobs did, as a table and a figure.

Snakemake's record of a job has its processor time. The job's log says which part of its clock JAX traced and compiled,
where it began as a copy of the run's process; without that line the job counts as ``not told``. Writes
``benchmarks/profile.csv`` (and .md, .tex, .pdf, .png) of the results.

Usage: python benchmarks/run_profile.py [results]
"""

import json
import sys
from collections import defaultdict
from pathlib import Path

import matplotlib.pyplot as plt

from hypernode.figures.style import INCLUSION, MATRIX, NEUTRAL, RC, SECOND, save
from hypernode.pipeline.phases import read_line
from hypernode.storage.provenance import code_hash, describe
from hypernode.tables.columns import Column
from hypernode.tables.table import Table, make_frame
from hypernode.tables.writing import write_table

#: What a job does, and its colour.
PARTS = {"tracing": SECOND, "compilation": INCLUSION, "rest": MATRIX, "not told": NEUTRAL}
COLUMNS = {
    "jobs": Column("jobs", "count"),
    "processor": Column("processor", "number", unit="s"),
    **{name: Column(name, "number", unit="s") for name in PARTS},
    "largest": Column("largest", "number", unit="s"),
    "of": Column("of", "text"),
}
#: Folders of ``benchmarks/`` that hold jobs of one rule each, named by what they make.
OF_ONE_RULE = {"figures": "figure", "tables": "table"}


def rule_of(name: Path) -> str:
    """The rule of a record, by its path in ``benchmarks/`` without the ending."""
    if name.parts[0] != "populations":
        return OF_ONE_RULE.get(name.parts[0], name.name)
    if len(name.parts) == 3:
        return "population_batch"
    return "population_table" if name.name.endswith("_table") else "population"


def job_rows(results: Path) -> list[dict]:
    """One row a job: its rule, what it is of, its processor seconds and their parts."""
    rows = []
    for path in sorted((results / "benchmarks").rglob("*.jsonl")):
        name = path.relative_to(results / "benchmarks").with_suffix("")
        record = json.loads(path.read_text(encoding="utf-8").splitlines()[-1])
        # A job that ends at once is gone before it is looked at.
        spent = 0.0 if record["cpu_time"] == "NA" else record["cpu_time"]
        log = results / "logs" / name.with_suffix(".log")
        told = read_line(log.read_text(encoding="utf-8", errors="replace")) if log.is_file() else None
        told = told or {"not told": 1.0}
        whole = sum(told.values()) or 1.0
        rows.append(
            {
                "rule": rule_of(name),
                "of": str(name.parent if name.parts[0] not in OF_ONE_RULE else name.name),
                "processor": spent,
                # The clock runs on while others have the core: of the parts, only the shares are told by it.
                **{part: spent * told.get(part, 0.0) / whole for part in PARTS},
            }
        )
    return rows


def by_rule(rows: list[dict]) -> list[dict]:
    """One row a rule, the dearest first."""
    rules = defaultdict(list)
    for row in rows:
        rules[row["rule"]].append(row)
    summed = []
    for rule, jobs in rules.items():
        worst = max(jobs, key=lambda job: job["processor"])
        sums = {key: sum(job[key] for job in jobs) for key in ("processor", *PARTS)}
        summed.append({"rule": rule, "jobs": len(jobs), **sums, "largest": worst["processor"], "of": worst["of"]})
    return sorted(summed, key=lambda row: -row["processor"])


def draw(rows: list[dict]):
    """A bar a rule, the dearest on top, divided by what its jobs did."""
    with plt.rc_context(RC):
        figure, axes = plt.subplots(figsize=(6.0, 0.6 + 0.2 * len(rows)), layout="constrained")
        left = [0.0] * len(rows)
        labels = [f"{row['rule']} ({row['jobs']})" for row in rows]
        for part, colour in PARTS.items():
            if any(row[part] for row in rows):
                axes.barh(labels, [row[part] for row in rows], left=left, color=colour, label=part)
                left = [start + row[part] for start, row in zip(left, rows, strict=True)]
        axes.invert_yaxis()
        axes.set_xlabel(f"processor time [s], {sum(row['processor'] for row in rows):.0f} s in all")
        axes.legend(loc="lower right")
    return figure


def main(results: str = "results"):
    """Write the table and the figure, and print the table."""
    rows = by_rule(job_rows(Path(results)))
    if not rows:
        sys.exit(f"{results}/benchmarks holds no record of a job: run make, or name the folder of another run")
    table = Table(make_frame(rows, ["rule"], COLUMNS), COLUMNS, list(COLUMNS))
    output = Path(results) / "benchmarks" / "profile"
    provenance = describe("benchmark", {}, {}, code_hash(Path(__file__)))
    files = {"csv": ".csv", "markdown": ".md", "latex": ".tex"}
    write_table(table, {kind: f"{output}{ending}" for kind, ending in files.items()}, provenance, [])
    save(draw(rows), {kind: f"{output}.{kind}" for kind in ("pdf", "png")}, provenance, [])
    print(output.with_suffix(".md").read_text(encoding="utf-8"))


if __name__ == "__main__":
    main(*sys.argv[1:])
