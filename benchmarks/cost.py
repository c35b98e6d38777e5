"""Time, memory and counted work of the constrained field against cells, load steps, terms, sheets and cores.

One thing is varied at a time; every measurement is a process of its own on one core (``cost_of_one.py``), with what it
compiles kept in a folder that is empty at the beginning. Times are of the processor, which others on the machine
stretch less than those of a clock; only several cores are measured by the clock. Counted work no one stretches.
With ``--against`` another commit is measured beside each, in turns. Writes ``results/benchmarks/cost.csv`` (and .md,
.tex) and ``cost.pdf`` (and .png) by default.

Usage: python benchmarks/cost.py [--cells 12 18 25 35 50] [--terms 2] [--series cells steps] [--against COMMIT]
"""

import argparse
import contextlib
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import LogLocator, ScalarFormatter

from hypernode.figures.style import INCLUSION, MATRIX, NEUTRAL, RC, SECOND, save
from hypernode.storage.provenance import code_hash, describe
from hypernode.tables.columns import Column
from hypernode.tables.table import Table, make_frame
from hypernode.tables.writing import write_table

ONE = Path(__file__).with_name("cost_of_one.py")
ROOT = ONE.parents[1]
#: What time is spent on, and its colour: colours that are told apart with any colour vision.
PARTS = {
    "import": "#999999",
    "compile": "#E69F00",
    "assembly": SECOND,
    "factorisation": "#CC79A7",
    "cg": MATRIX,
    "other": NEUTRAL,
}
COUNTS = ("tangents", "evaluations", "factorisations", "solves", "cg_products")
COLUMNS = {
    "time": Column("total_s", "number", unit="s"),
    "time without imports and compilation": Column("run_s", "number", unit="s"),
    "peak memory": Column("memory_MB", "number", unit="MB"),
    **{name: Column(f"{name}_s", "number", unit="s") for name in PARTS},
    **{name.replace("_", " "): Column(name, "count") for name in COUNTS},
    "clock a sheet": Column("clock_s", "number", unit="s"),
    "time, ratio": Column("time_ratio", "number"),
    "memory, ratio": Column("memory_ratio", "number"),
    "solves, ratio": Column("solves_ratio", "number"),
}
LABELS = ["series", "value", "cells a side", "steps", "terms", "sheets", "cores", "code"]
#: Series -> its values, and the axis of its figure.
SERIES = {"steps": [1, 2, 4, 8], "terms": [1, 2, 4], "sheets": [1, 2, 4], "cores": [1, 2]}
AXES = {"cells": "cells", "steps": "load steps", "terms": "terms", "sheets": "sheets of a job", "cores": "cores"}
BASE = {"cells": 16, "steps": 4, "terms": 2, "sheets": 1}


def measured(source: Path, cache: str, what: dict, cores: int = 1) -> dict:
    """What one process takes, or the mean of as many as there are cores, which run side by side."""
    environment = {**os.environ, "PYTHONPATH": str(source), "HYPERNODE_CACHE": cache, "OPENBLAS_NUM_THREADS": "1"}
    line = [sys.executable, str(ONE), json.dumps(what)]
    begun = time.perf_counter()
    running = [
        subprocess.Popen(line, env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        for _ in range(cores)
    ]
    found = [json.loads(process.communicate()[0].splitlines()[-1]) for process in running]
    numbers = [key for key, value in found[0].items() if not isinstance(value, str)]
    mean = {key: float(np.mean([each.get(key, 0) for each in found])) for key in numbers}
    return mean | {"clock_s": (time.perf_counter() - begun) / cores / what["sheets"]}


def exponent(x, y) -> float:
    """Slope of log y over log x, by least squares; NaN of one point."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0]) if len(x) > 1 else float("nan")


@contextlib.contextmanager
def source_of(commit: str | None):
    """The folder with the package as of a commit, in a git worktree of its own while the block runs."""
    if commit is None:
        yield None
        return
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "then"
        subprocess.run(["git", "-C", ROOT, "worktree", "add", "--detach", place, commit], check=True)
        try:
            yield place / "src"
        finally:
            subprocess.run(["git", "-C", ROOT, "worktree", "remove", "--force", place], check=True)


def rows_of(series: dict[str, list[int]], base: dict, then: Path | None, commit: str | None) -> list[dict]:
    """Every measurement, with ratios to another version where there is one."""
    rows = []
    with tempfile.TemporaryDirectory() as cache:
        for name, values in series.items():
            for value in values:
                cores = value if name == "cores" else 1
                what = base | ({name: value} if name != "cores" else {})
                labels = {"series": name, "value": value, "cells a side": what["cells"], "cores": cores}
                labels |= {key: what[key] for key in ("steps", "terms", "sheets")}
                now = measured(ROOT / "src", f"{cache}/now", what, cores)
                rows.append(labels | {"code": "now"} | now)
                if then is not None:
                    before = measured(then, f"{cache}/then", what, cores)
                    rows[-1] |= {
                        "time_ratio": now["total_s"] / before["total_s"],
                        "memory_ratio": now["memory_MB"] / before["memory_MB"],
                        "solves_ratio": now["solves"] / before["solves"],
                    }
                    rows.append(labels | {"code": commit} | before)
                print(f"{name} {value}: {now['total_s']:.1f} s, {now['memory_MB']:.0f} MB", flush=True)
    return rows


def named(row: dict) -> dict:
    """A row by the names of the columns of the table."""
    return {label: row[label] for label in LABELS} | {
        name: row.get(column.key) if column.style != "count" else round(row[column.key])
        for name, column in COLUMNS.items()
    }


def position(row: dict) -> int:
    """Where a row stands on the axis of its series."""
    return row["value"] ** 2 if row["series"] == "cells" else row["value"]


def fits(rows: list[dict]) -> dict[str, tuple[float, float]]:
    """Series -> exponents of time, imports and compilation left out, and of memory."""
    found = {}
    for name in dict.fromkeys(row["series"] for row in rows):
        own = [row for row in rows if row["series"] == name and row["code"] == "now"]
        x = [position(row) for row in own]
        time_of = "clock_s" if name == "cores" else "run_s"
        found[name] = tuple(exponent(x, [row[key] for row in own]) for key in (time_of, "memory_MB"))
    return found


def draw(rows: list[dict], exponents: dict):
    """Time, memory and what time is spent on, a column a series."""
    with plt.rc_context(RC):
        figure, panels = plt.subplots(
            3, len(exponents), figsize=(1.75 * len(exponents) + 0.6, 5.0), squeeze=False, layout="constrained"
        )
        for column, (name, (of_time, of_memory)) in zip(panels.T, exponents.items(), strict=True):
            own = [row for row in rows if row["series"] == name and row["code"] == "now"]
            others = [row for row in rows if row["series"] == name and row["code"] != "now"]
            x = np.array([position(row) for row in own])
            key, what = ("clock_s", "clock") if name == "cores" else ("run_s", "time")
            column[0].loglog(x, [row[key] for row in own], "o-", color=MATRIX, label=f"now, ~ $n^{{{of_time:.2f}}}$")
            column[1].loglog(
                x, [row["memory_MB"] for row in own], "o-", color=MATRIX, label=f"now, ~ $n^{{{of_memory:.2f}}}$"
            )
            for axes, value in ((column[0], key), (column[1], "memory_MB")):
                if others:
                    label = others[0]["code"]
                    axes.loglog(x, [row[value] for row in others], "s--", color=INCLUSION, label=label)
                axes.legend()
                axes.set_xticks(x, map(str, x))
                # Less than a decade has few powers of ten.
                axes.set_ylim(axes.dataLim.y0 / 1.5, axes.dataLim.y1 * 1.5)
                axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
                axes.yaxis.set_major_formatter(ScalarFormatter())
                axes.minorticks_off()
            column[0].set_ylabel(f"{what}{' a sheet' if name == 'cores' else ''} [s]")
            column[1].set_ylabel("peak memory [MB]")
            bottom, places = np.zeros(len(own)), np.arange(len(own))
            for part, colour in PARTS.items():
                share = np.array([row.get(f"{part}_s", 0.0) / row["total_s"] for row in own])
                column[2].bar(places, share, 0.7, bottom, color=colour, label=part)
                bottom += share
            column[2].set_xticks(places, map(str, x))
            column[2].set_ylabel("share of the time [-]")
            for axes in column:
                axes.set_xlabel(f"{AXES[name]} [-]")
        handles, labels = panels[2, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(PARTS))
        return figure


def main() -> None:
    """Measure, print the exponents and store table and figure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, nargs="+", default=[12, 18, 25, 35, 50], help="cells a side")
    parser.add_argument("--terms", type=int, choices=(1, 2, 4), default=BASE["terms"], help="of all but their series")
    parser.add_argument("--series", nargs="+", choices=AXES, default=list(AXES))
    parser.add_argument("--against", metavar="COMMIT")
    parser.add_argument("--output", default="results/benchmarks/cost", help="files without their endings")
    given = parser.parse_args()
    series = {name: {"cells": given.cells, **SERIES}[name] for name in given.series}
    series = {name: [v for v in values if name != "cores" or v <= os.cpu_count()] for name, values in series.items()}
    base = BASE | {"terms": given.terms}
    with source_of(given.against) as then:
        rows = rows_of(series, base, then, given.against)
    exponents = fits(rows)
    notes = [f"{name}: time ~ n^{t:.2f}, memory ~ n^{m:.2f}" for name, (t, m) in exponents.items()]
    print("\n".join(notes))
    provenance = describe("benchmark", {}, {"series": series, "base": base}, code_hash(__file__))
    shown = ["time", "time without imports and compilation", "peak memory", "solves", "time, ratio"]
    table = Table(make_frame([named(row) for row in rows], LABELS, COLUMNS), COLUMNS, shown, notes=notes)
    files = {"csv": ".csv", "markdown": ".md", "latex": ".tex"}
    write_table(table, {kind: given.output + ending for kind, ending in files.items()}, provenance, [])
    save(draw(rows, exponents), {kind: f"{given.output}.{kind}" for kind in ("pdf", "png")}, provenance, [])


if __name__ == "__main__":
    main()
