"""``hypernode explain RUN``: what was tried to identify a field, and why one candidate was kept."""

import json
from pathlib import Path

from hypernode.errors import ExpectedError
from hypernode.verdict import Level

#: Criteria whose sentence is an answer and not a judgement.
ANSWERS = ("contrast", "volume", "other deformations", "inclusion")


class NothingToExplain(ExpectedError, ValueError):
    """A run has no record of candidates; the message says why and what to do."""


def add_explain(commands) -> None:
    """``explain RUN``."""
    parser = commands.add_parser("explain", help="what was tried to identify a field, and why one candidate was kept")
    parser.add_argument("folder", type=Path, metavar="RUN", help="folder of a run, results/CASE/METHOD")
    parser.add_argument("--json", action="store_true", help="for machines")
    parser.set_defaults(run=explain)


def explain(arguments) -> int:
    """Print the candidates of a run, and in sentences what decided between them."""
    from hypernode.tables.verdicts import read_verdicts
    from hypernode.trace import table

    rows = rows_of(arguments.folder)
    if arguments.json:
        print(json.dumps(rows, indent=1))
        return 0
    print("\n".join([*table(rows), "", *reasons(rows)]))
    evaluation = arguments.folder / "evaluation.nc"
    if evaluation.is_file():
        ((_, verdict),) = read_verdicts([evaluation])
        known = [each.sentence for each in verdict.criteria if each.name in ANSWERS and each.level is Level.PASSED]
        print("\n".join(["", f"verdict: {verdict.overall}", *(f"  {each}" for each in (*verdict.words, *known))]))
    return 0


def rows_of(run: Path) -> list[dict]:
    """Rows of the trace of a run.

    Raises:
        NothingToExplain: the run has no constrained field, or an older one without a record.
    """
    from hypernode.storage.netcdf import read
    from hypernode.trace import read as trace_of

    file = run / "constrained.nc"
    if not file.is_file():
        raise NothingToExplain(
            f"{run}: holds no constrained.nc. Name the folder of a run, results/CASE/METHOD, of a method that searches "
            "for an equilibrium field, as hypernode and field do"
        )
    rows = trace_of(read(file).attrs)
    if not rows:
        raise NothingToExplain(f"{file}: is of a version that kept no record of candidates: delete it and run again")
    return rows


def reasons(rows: list[dict]) -> list[str]:
    """What decided, in sentences: the kept candidate, then the best of every other number of materials and terms."""
    from hypernode.trace import KEPT, parts

    kept = next(row for row in rows if row["reason"] == KEPT)
    lines = [f"Kept: {_named(kept)}, {kept['ending']}; displacements are missed by {_misfit(kept)} of their noise."]
    promised = sorted(kept.get("promises", {}).items(), key=lambda each: -each[1])
    if promised:
        told = ", ".join(f"{term} {gain:+.1f}" for term, gain in promised)
        lines.append(f"Terms that could join promised to improve the score by: {told}. Small promises were not tried.")
    others: dict[tuple, dict] = {}
    for row in rows:
        key = (row["materials"], tuple(row["terms"]))
        if key != (kept["materials"], tuple(kept["terms"])):
            others[key] = min(row, others.get(key, row), key=lambda each: each["total"])
    for row in sorted(others.values(), key=lambda each: each["total"]):
        lines.append(
            f"Not {_named(row)} ({row['number']}): {row['reason']}; over the kept one by parts: {parts(row, kept)}."
        )
    return lines


def _named(row: dict) -> str:
    count = row["materials"]
    of = "a material in every cell" if not count else "one material" if count == 1 else f"{count} materials"
    return f"{of} with the terms {', '.join(row['terms']) or 'neo-Hookean'}"


def _misfit(row: dict) -> str:
    return f"{row['misfits']['displacement']:.2f}"
