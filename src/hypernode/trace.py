"""What a search tried, how each candidate scored, and why it was kept or passed over.

A candidate is recorded once, where its descent ends. Estimates carry the record of all that led to them, so that the
one which is kept in the end tells the whole search.
"""

import itertools
import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, fields, replace

#: Reason of the candidate that was kept in the end.
KEPT = "kept"
#: Columns of the table of candidates.
HEAD = ("no", "tried", "from", "terms", "materials", "u misfit", "force misfit", "score", "ending", "why")
#: Reason of those that a later one began from.
BEGUN = "a later candidate begins here"


@dataclass(frozen=True, kw_only=True)
class Score:
    """Minus the logarithm of how probable a field is after the test, by parts; the smallest total is the best.

    Differences between candidates for the same data count: a difference of 5 is odds of 150 to 1.

    Attributes:
        displacements, forces: half of the squared misfits over their uncertainty.
        prior: what jumps or interfaces cost, and the distance of parameters from the homogeneous fit.
        noise: half the logarithm of the determinant of the covariance of the residuals, constants left out.
        terms: half the logarithm of the number of data for each parameter of the terms (Schwarz 1978).
        determined: one for each number of the field that the data determine (Akaike 1974).
        places: logarithm of the number of places where an interface might be.
    """

    displacements: float
    forces: float
    prior: float
    noise: float
    terms: float
    determined: float
    places: float = 0.0

    @property
    def total(self) -> float:
        """Sum of all parts."""
        return sum(asdict(self).values())


@dataclass(frozen=True, eq=False, kw_only=True)
class Trial:
    """One candidate; two are the same only if they are one object.

    Attributes:
        move: what was tried, in words.
        start: the candidate that it began from, or None for the homogeneous sheet.
        terms: of its law.
        materials: number of materials, 0 where every cell has its own.
        misfits: root mean square over the uncertainty, by name.
        score: None where a search ended without an equilibrium.
        ending: how its descent ended.
        promises: by how much each term that may join promised to improve the score, by a score test.
        order: of when it was tried among all others; rows are renumbered, so that no file depends on it.
    """

    move: str
    start: "Trial | None"
    terms: tuple[str, ...]
    materials: int
    misfits: Mapping[str, float]
    score: Score
    ending: str
    promises: Mapping[str, float] = field(default_factory=dict)
    order: int = field(default_factory=itertools.count().__next__)


@dataclass(frozen=True)
class Trace:
    """All candidates in the order in which they were tried.

    Attributes:
        reasons: candidate -> why it was passed over, "" as long as it is not.
    """

    reasons: Mapping[Trial, str] = field(default_factory=dict)

    def __or__(self, other: "Trace") -> "Trace":
        """Candidates of both. A reason that ``other`` has stands."""
        merged = dict(self.reasons)
        for trial, reason in other.reasons.items():
            merged[trial] = reason or merged.get(trial, "")
        return Trace(merged)

    def with_trial(self, trial: Trial) -> "Trace":
        """The same and one more candidate."""
        return Trace({**self.reasons, trial: ""})

    def passed_over(self, trials: Mapping[Trial | None, str]) -> "Trace":
        """The same with reasons against some candidates."""
        return replace(self, reasons={t: trials.get(t, reason) for t, reason in self.reasons.items()})

    def rows(self, kept: Trial | None) -> list[dict]:
        """One row a candidate, as files hold it.

        Args:
            kept: the candidate that is the answer.
        """
        in_order = sorted(self.reasons, key=lambda trial: trial.order)
        number = {trial: k + 1 for k, trial in enumerate(in_order)}
        led, each = set(), kept
        while each is not None:
            led.add(each)
            each = each.start
        rows = []
        for trial in in_order:
            reason = self.reasons[trial]
            if trial is kept:
                reason = KEPT
            elif trial in led or not reason:
                reason = reason or BEGUN
            rows.append(
                {
                    "number": number[trial],
                    "move": trial.move,
                    "start": number.get(trial.start, 0),
                    "terms": list(trial.terms),
                    "materials": trial.materials,
                    "misfits": dict(trial.misfits),
                    "score": asdict(trial.score),
                    "total": trial.score.total,
                    "ending": trial.ending,
                    "reason": reason,
                    "promises": dict(trial.promises),
                }
            )
        return rows


def stored(rows: list[dict]) -> str:
    """Rows of a trace as an attribute of a file."""
    return json.dumps(rows)


def read(attributes: Mapping[str, object]) -> list[dict]:
    """Rows of a trace from the attributes of a constrained field; none where it has no trace."""
    return json.loads(str(attributes.get("trace", "[]")))


def cells(rows: Iterable[Mapping]) -> list[tuple[str, ...]]:
    """Texts of a table of candidates under :data:`HEAD`; scores are those over that of the kept one."""
    rows = list(rows)
    kept = next((row["total"] for row in rows if row["reason"] == KEPT), float("nan"))
    return [
        (
            str(row["number"]),
            row["move"],
            str(row["start"] or "-"),
            " ".join(row["terms"]) or "neo-Hookean",
            str(row["materials"] or "by cell"),
            f"{row['misfits']['displacement']:.2f}",
            f"{row['misfits']['force']:.2f}",
            f"{row['total'] - kept:+.1f}",
            row["ending"],
            row["reason"],
        )
        for row in rows
    ]


def table(rows: Iterable[Mapping]) -> list[str]:
    """Lines of a table of candidates."""
    lines = [HEAD, *cells(rows)]
    widths = [max(len(line[k]) for line in lines) for k in range(len(HEAD))]
    return ["  ".join(cell.ljust(w) for cell, w in zip(line, widths, strict=True)).rstrip() for line in lines]


def parts(row: Mapping, kept: Mapping) -> str:
    """By which parts a candidate scores worse than the kept one, the largest first, in words."""
    difference = {part.name: row["score"][part.name] - kept["score"][part.name] for part in fields(Score)}
    largest = sorted(difference.items(), key=lambda each: -abs(each[1]))
    return ", ".join(f"{name} {value:+.1f}" for name, value in largest if abs(value) >= 0.05)
