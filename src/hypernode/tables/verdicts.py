"""Verdicts as evaluations hold them: read, counted, and printed the worst run first."""

import json
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from hypernode.errors import ExpectedError
from hypernode.storage.netcdf import read
from hypernode.verdict import Level, Verdict


class VerdictError(ExpectedError, ValueError):
    """There is no verdict where one was asked for; the message names the file and the way out."""


class RunVerdict(NamedTuple):
    """The verdict on one run, ``case/method``."""

    run: str
    verdict: Verdict

    @classmethod
    def of(cls, evaluation: xr.Dataset, where: str = "evaluation.nc") -> "RunVerdict":
        """The verdict of an opened evaluation.

        Raises:
            VerdictError: it has none.
        """
        if "verdict" not in evaluation.attrs:
            raise VerdictError(f"{where}: holds no verdict: it is of an older version; delete it and run again")
        run, verdict = (json.loads(evaluation.attrs[key]) for key in ("run", "verdict"))
        return cls(f"{run['case']}/{run['method']}", Verdict.of(verdict))


def read_verdicts(files: Iterable[str | Path]) -> list[RunVerdict]:
    """The verdicts of evaluation files, the worst first, then by name.

    Raises:
        StorageError: a file is missing or damaged.
        VerdictError: a file holds no verdict.
    """
    found = [RunVerdict.of(read(file), str(file)) for file in files]
    return sorted(found, key=lambda each: (-each.verdict.overall.rank, each.run))


def evaluations(folder: Path) -> list[Path]:
    """The evaluation files of a results folder.

    Raises:
        VerdictError: there are none.
    """
    found = sorted(folder.glob("*/*/evaluation.nc"))
    if not found:
        raise VerdictError(f"{folder}: holds no <case>/<method>/evaluation.nc; name a results folder of a finished run")
    return found


def listing(verdicts: list[RunVerdict]) -> list[str]:
    """One line a run: its level, its name, a sentence for every criterion that it does not meet, and its suspects."""
    width = max(len(each.run) for each in verdicts)
    return [f"{each.overall}  {run:{width}}  {' '.join(each.words)}".rstrip() for run, each in verdicts]


def count(levels: Iterable[str]) -> str:
    """How many of each level there are, the best first: ``7 pass, 2 warn``."""
    counted = Counter(levels)
    return ", ".join(f"{counted[level]} {level}" for level in Level if counted[level])


def tally(files: Iterable[str]) -> str:
    """One line at the end of a workflow: how many of its runs pass, warn and fail, and where to read why.

    A workflow that was asked for less than all has no evaluation of some runs. It has succeeded in any case, so that
    a verdict that cannot be read is said and not raised.
    """
    try:
        levels = [each.verdict.overall for each in read_verdicts(file for file in files if Path(file).is_file())]
    except ExpectedError as error:
        return f"verdicts cannot be counted: {error}"
    return f"verdicts: {count(levels) or 'no run is evaluated'}; 'hypernode verdict' says why"
