"""``hypernode advise results/CASE/METHOD``: which further test of a sheet would tell most about its stress."""

import csv
import dataclasses
import json
import math
import sys
from pathlib import Path

from hypernode.commands.options import UsageError

#: How much larger a larger test is, and how many random vectors estimate a spread, where nothing is given.
LARGER, PROBES = 1.5, 8


def add_advise(commands) -> None:
    """``advise FOLDER``."""
    parser = commands.add_parser(
        "advise", help="rank further tests of an identified sheet by how much they would narrow its stress"
    )
    parser.add_argument("folder", type=Path, metavar="results/CASE/METHOD", help="a finished run")
    parser.add_argument(
        "--larger", type=float, default=LARGER, metavar="FACTOR", help=f"of the larger test over the present ({LARGER})"
    )
    parser.add_argument(
        "--probes", type=int, default=PROBES, metavar="N", help=f"random vectors that estimate a spread ({PROBES})"
    )
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="for machines")
    form.add_argument("--csv", action="store_true", help="the table as comma-separated values")
    parser.set_defaults(run=run_advise)


def run_advise(arguments) -> int:
    """Print the ranked tests and which of them is worth doing next.

    Raises:
        UsageError: an option makes no sense.
        StorageError, AdviceError: the run cannot be read, or no advice can be given on it.
    """
    if not 1.0 < arguments.larger < math.inf:
        raise UsageError(f"--larger {arguments.larger}: more than one")
    if arguments.probes < 2:
        raise UsageError(f"--probes {arguments.probes}: two or more, of which the scatter is told")
    from hypernode.pipeline.compiler import set_up_compiler

    set_up_compiler(float64=True)
    from hypernode.stages.advice import run

    found = run(arguments.folder, arguments.larger, arguments.probes)
    if arguments.json:
        print(json.dumps(as_json(found), indent=1, allow_nan=False))
    elif arguments.csv:
        rows = as_json(found)["tests"]
        table = csv.DictWriter(sys.stdout, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    else:
        print("\n".join(listing(found)))
    return 0


def as_json(advice) -> dict:
    """Everything that was found out, numbers that are not as None."""
    tests = [
        {k: None if isinstance(v, float) and not math.isfinite(v) else v for k, v in dataclasses.asdict(test).items()}
        for test in advice.tests
    ]
    return {"spread": advice.before, "stress": advice.stress, "tests": tests, "sentence": advice.sentence}


def listing(advice) -> list[str]:
    """The table and the sentence."""
    width = max(len(test.name) for test in advice.tests)
    lines = [
        f"spread of the stress now: {_percent(advice.before)}",
        "",
        f"{'further test':{width}}  spread then   less by",
    ]
    for test in advice.tests:
        if test.refused:
            lines.append(f"{test.name:{width}}  {test.refused}")
            continue
        less = f"{100.0 * test.reduction:.1f} ± {100.0 * test.uncertainty:.1f} %"
        lines.append(f"{test.name:{width}}  {_percent(test.spread):>11}   {less}")
    return [*lines, "", advice.sentence]


def _percent(value: float) -> str:
    return f"{100.0 * value:#.3g} %"
