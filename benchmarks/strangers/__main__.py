"""Sheets of several seeds, side by side, then a table and a figure of all that are scored.

A sheet that has a score is not run again: delete its folder, or give --again, where the code has changed. A sheet that
ends with an error is a row that says so. Seeds below 100 may be looked at while something is set; tables of the
documentation are of seeds from 1001 on (docs/decisions/0066-sheets-of-strangers.md).

Usage: python -m benchmarks.strangers SEED [SEED ...] [--cores 2] [--to .cache/strangers] [--again]
"""

import argparse
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from benchmarks.strangers.report import draw, notes, table_of
from benchmarks.strangers.running import scored
from hypernode.figures.style import save
from hypernode.storage.provenance import code_hash, describe
from hypernode.tables.writing import write_table


def row_of(seed: int, folder: Path) -> dict:
    """The score of a seed, or its error; runs it where it has none."""
    row = scored("benchmarks.strangers.one", [str(seed), str(folder.resolve())], folder)
    if isinstance(row, str):
        print(f"{seed}: {row}", flush=True)
        return {"seed": seed, "error": row}
    print(
        f"{seed}: {row['tested']:.4f} off interfaces, {row['everywhere']:.4f} everywhere, {row['verdict']}, "
        f"{row['cpu_s']:.0f} s",
        flush=True,
    )
    return row


def main() -> None:
    """Run what has no score, and write ``strangers.csv``, ``.md``, ``.tex``, ``.pdf`` and ``.png``."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("seeds", type=int, nargs="+", metavar="SEED")
    parser.add_argument("--cores", type=int, default=2, help="sheets side by side (2)")
    parser.add_argument("--to", type=Path, default=Path(".cache/strangers"), help="folder of the sheets")
    parser.add_argument("--again", action="store_true", help="identify sheets again that have a score")
    parser.add_argument("--output", default="results/benchmarks/strangers", help="files without their endings")
    given = parser.parse_args()
    for seed in given.seeds if given.again else []:
        shutil.rmtree(given.to / str(seed) / "brought" / "results", ignore_errors=True)
        (given.to / str(seed) / "score.json").unlink(missing_ok=True)
    with ThreadPoolExecutor(given.cores) as pool:
        rows = list(pool.map(lambda seed: row_of(seed, given.to / str(seed)), given.seeds))
    print("\n".join(notes(rows)))
    provenance = describe("benchmark", {}, {"seeds": given.seeds}, code_hash(__file__))
    files = {"csv": ".csv", "markdown": ".md", "latex": ".tex"}
    write_table(table_of(rows), {kind: given.output + ending for kind, ending in files.items()}, provenance, [])
    save(draw(rows), {kind: f"{given.output}.{kind}" for kind in ("pdf", "png")}, provenance, [])


if __name__ == "__main__":
    main()
