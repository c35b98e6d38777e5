"""The level of the stress of known sheets, its stated uncertainty, and where their law is refuted.

Sheets are computed by other finite elements than the project's (``benchmarks/strangers``), brought as files, and
identified by method ``field``. A sheet that has a score with the same further keys is not run again.

Usage: python -m benchmarks.level STUDY [NAME ...] [--cores 2] [--to .cache/level] [--set KEY=VALUE]
STUDY is ``seen``, ``records``, ``laws`` or ``volume`` (benchmarks/level/designs.py); NAME is a part of the names of
its sheets.
"""

import argparse
import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from benchmarks.level.designs import STUDIES
from benchmarks.level.one import SPREADS
from benchmarks.strangers.running import scored

#: Stated standard uncertainty up to which a level is known well.
NARROW = 0.05


def row_of(study: str, name: str, folder: Path, changed: dict) -> dict:
    """The score of a sheet, or its error; runs it where it has none with these keys changed."""
    file = folder / "score.json"
    if file.is_file() and json.loads(file.read_text()).get("changed", {}) != changed:
        file.unlink()
    row = scored("benchmarks.level.one", [study, name, str(folder.resolve()), json.dumps(changed)], folder)
    if isinstance(row, str):
        print(f"{name:36} {row}", flush=True)
        return {"name": name, "error": row}
    print(_line(row), flush=True)
    return row


def _line(row: dict) -> str:
    """One sheet: level over the true one, its stated uncertainty, errors, refuted share, verdict."""
    within = "within" if row["within"] else "BEYOND"
    modes = ", ".join(f"{mode} {error:.3f} +- {doubt:.3f}" for mode, (error, doubt) in row["modes"].items())
    return (
        f"{row['name']:36} level {row['level']:.3f} +- {row['stated']:.3f} {within}, tested {row['tested']:.4f}, "
        f"refuted in {row['refuted']:.3f}, {row['verdict']} ({row['because']}), {row['cpu_s']:.0f} s; {modes}"
    )


def summed(rows: list[dict]) -> list[str]:
    """Sentences about all sheets of a study."""
    good = [row for row in rows if "error" not in row]
    if not good:
        return [f"{len(rows)} sheets, none scored."]
    within = sum(row["within"] for row in good)
    narrow = sum(row["stated"] <= NARROW for row in good)
    known = f"level within {SPREADS:g} spreads in {within}, spread <= {NARROW:.0%} in {narrow}"
    found = [f"{len(rows)} sheets, {len(good)} scored: {known}."]
    for says in ("right", "wrong"):
        own = [row for row in good if row["name"].startswith(says)]
        if own:
            missed, told = (sum(row[key] for row in own) for key in ("law_refuted", "told"))
            found.append(f"{says} laws: {missed} of {len(own)} refuted, {told} of {len(own)} told by warn or fail.")
    return found


def main() -> None:
    """Run what has no score, and say what it is together."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", choices=STUDIES)
    parser.add_argument("names", nargs="*", metavar="NAME", help="parts of the names of sheets (all)")
    parser.add_argument("--cores", type=int, default=2, help="sheets side by side (2)")
    parser.add_argument("--to", type=Path, default=Path(".cache/level"), help="folder of the sheets")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="further key of the specimen")
    given = parser.parse_args()
    chosen = [name for name in STUDIES[given.study]() if not given.names or any(part in name for part in given.names)]
    changed = {key: json.loads(value) for key, value in (each.split("=", 1) for each in given.set)}
    with ThreadPoolExecutor(given.cores) as pool:
        rows = list(pool.map(lambda name: row_of(given.study, name, given.to / name, changed), chosen))
    print("\n".join(summed(rows)))


if __name__ == "__main__":
    main()
