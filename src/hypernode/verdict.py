"""How a run ended and how far it can be believed: the words that files, tables, figures and commands share."""

import enum
from collections.abc import Mapping
from dataclasses import KW_ONLY, asdict, dataclass

#: Criterion that is said in any case and first, since of a field that is still descending other numbers mean little
#: -> what a verdict calls it where it is not met.
UNMET = {"convergence": "not converged"}


class Ending(enum.StrEnum):
    """How a descent ended; without equilibrium at its start there is no field, but an error."""

    #: The data are explained, and one more step would change the cost by less than its tolerance.
    CONVERGED = "converged"
    #: No step lowers the cost any more, or the misfit hardly falls, before the data are explained to the tolerance.
    STAGNATED = "stagnated"
    #: It was still descending.
    OUT_OF_ITERATIONS = "out of iterations"
    #: No descent led here: parameters that another one may begin at.
    UNFINISHED = "unfinished"


class Level(enum.StrEnum):
    """What a criterion says, from the best to the worst; ``NOT_JUDGED`` where a run lacks the number."""

    NOT_JUDGED = "not judged"
    PASSED = "pass"
    WARNED = "warn"
    FAILED = "fail"

    @property
    def rank(self) -> int:
        """Larger is worse."""
        return list(Level).index(self)


@dataclass(frozen=True)
class Criterion:
    """One thing that a run is asked.

    Attributes:
        name: what it is about.
        level: what it says.
        sentence: the same in words.
        value: the number judged, None where there is none or it is not finite.
        threshold: the threshold that was passed, or else the first one, in the unit of ``value``.
    """

    name: str
    level: Level
    sentence: str
    _: KW_ONLY
    value: float | None = None
    threshold: float | None = None

    @property
    def unmet(self) -> bool:
        """Whether it warns or fails."""
        return self.level in (Level.WARNED, Level.FAILED)


@dataclass(frozen=True)
class Suspect:
    """What may be to blame for criteria that are not met.

    Attributes:
        name: of the cause.
        weight: how much of what is missed has its pattern, 0 to 1.
        sentence: what speaks for it.
    """

    name: str
    weight: float
    sentence: str


@dataclass(frozen=True)
class Verdict:
    """All criteria of a run.

    Attributes:
        criteria: what was asked.
        suspects: the likeliest causes of those that are not met, the likeliest first.
    """

    criteria: tuple[Criterion, ...]
    suspects: tuple[Suspect, ...] = ()

    @property
    def overall(self) -> Level:
        """The worst level of the criteria that are judged."""
        return max((criterion.level for criterion in self.criteria), key=lambda level: level.rank)

    @property
    def label(self) -> str:
        """The overall level, and the criteria that are to blame: ``pass``, ``warn: not converged``.

        Those of the worst level; that a run did not converge is said in any case.
        """
        unmet = [c for c in self.criteria if c.unmet]
        blamed = [UNMET.get(c.name, c.name) for c in unmet if c.level is self.overall or c.name in UNMET]
        return f"{self.overall}: {', '.join(blamed)}" if blamed else str(self.overall)

    @property
    def ranked(self) -> list[Criterion]:
        """All criteria: convergence where it is not met, since all else depends on it, then the worst first."""
        return sorted(self.criteria, key=lambda c: (not (c.unmet and c.name in UNMET), -c.level.rank))

    @property
    def sentences(self) -> list[str]:
        """Those of the criteria that are not met, in the order of :attr:`ranked`."""
        return [c.sentence for c in self.ranked if c.unmet]

    @property
    def causes(self) -> list[str]:
        """A sentence on each suspect, the likeliest first."""
        return [f"Suspect: {each.name}. {each.sentence}" for each in self.suspects]

    @property
    def words(self) -> list[str]:
        """All that is said of a run that does not pass: :attr:`sentences`, then :attr:`causes`."""
        return [*self.sentences, *self.causes]

    @classmethod
    def of(cls, stored: Mapping) -> "Verdict":
        """The verdict that :meth:`stored` gave."""
        criteria = ({**each, "level": Level(each["level"])} for each in stored["criteria"])
        suspects = tuple(Suspect(**each) for each in stored.get("suspects", ()))
        return cls(tuple(Criterion(**each) for each in criteria), suspects)

    def stored(self) -> dict:
        """The verdict as result files hold it: ``overall``, ``criteria`` and ``suspects``."""
        told = {"criteria": self.criteria, "suspects": self.suspects}
        return {"overall": str(self.overall)} | {key: [asdict(each) for each in told[key]] for key in told}
