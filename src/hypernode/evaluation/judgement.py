"""The result of an evaluation: fields to store and single numbers to tabulate."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from hypernode.evaluation.level_budget import LevelBudget


@dataclass(frozen=True)
class Judgement:
    """A part of an evaluation; parts are joined by ``|``.

    Attributes:
        variables: arrays by the name of the stored variable.
        summary: numbers by the key that tables look up.
        budget: of the level of the stress; None where no force was recorded, or in another part.
    """

    variables: Mapping[str, object] = field(default_factory=dict)
    summary: Mapping[str, object] = field(default_factory=dict)
    budget: LevelBudget | None = None

    def __or__(self, other: "Judgement") -> "Judgement":
        twice = self.variables.keys() & other.variables.keys() | self.summary.keys() & other.summary.keys()
        if twice:
            raise ValueError(f"judged twice: {', '.join(sorted(twice))}")
        variables, summary = {**self.variables, **other.variables}, {**self.summary, **other.summary}
        return Judgement(variables, summary, self.budget or other.budget)
