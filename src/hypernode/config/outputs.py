"""The schema of what is drawn and tabulated."""

from typing import Annotated, Literal, Union

from pydantic import Discriminator, Field, Tag, model_validator

from hypernode.config.section import Positive, Section
from hypernode.config.synthetic import LoadKind

#: Columns of a table that people read, its labels among them.
MOST_COLUMNS = 10


class RunFigure(Section):
    """A figure of one run: ``kind`` names its layout, ``step`` the load step drawn."""

    kind: Literal["identification", "anisotropy", "overview", "references"]
    case: str
    method: str
    step: int = -1


class ShownRun(Section):
    """A row of a comparison: a run, or what one of its stages left."""

    case: str
    method: str
    stage: Literal["constrained", "initialised", "pretrained", "material"] = "material"
    label: str


class Comparison(Section):
    """A figure of several runs: their fields, or the fields' errors, at several stretches."""

    kind: Literal["comparison"]
    runs: list[ShownRun] = Field(min_length=1)
    stretches: list[Positive] = Field(min_length=1)
    load: LoadKind = "equibiaxial"
    show: Literal["stress", "error"] = "stress"


Figure = Annotated[Union[RunFigure, Comparison], Field(discriminator="kind")]


class RunTable(Section):
    """Numbers of the runs ``case/method`` that match a pattern, one by one or in groups.

    An ``ensemble`` compares the fields of the runs of each group, which are of one case.
    """

    kind: Literal["runs", "timing", "validation", "references", "ensemble"] = "runs"
    runs: list[str] = ["*"]
    columns: list[str] = []
    groups: dict[str, str] = {}

    @model_validator(mode="after")
    def _readable(self):
        if self.columns and self.kind in ("timing", "ensemble"):
            raise ValueError(f"columns: a table of kind '{self.kind}' shows all that it has; leave 'columns' out")
        if len(set(self.columns)) < len(self.columns):
            raise ValueError("columns: one is named twice; leave it once")
        labels = ("group", "runs", "statistic") if self.groups else ("case", "method")
        room = MOST_COLUMNS - len(labels)
        if len(self.columns) > room:
            raise ValueError(
                f"columns: {len(self.columns)} beside {', '.join(labels)} are more than a page holds; name at most "
                f"{room}, since the CSV file has all of them anyway"
            )
        return self


class SettingsTable(Section):
    """A section of the configuration as a table."""

    kind: Literal["settings"]
    section: Literal["materials", "loads", "methods", "noise"]


def _layout(table) -> str:
    kind = table.get("kind") if isinstance(table, dict) else getattr(table, "kind", None)
    return "settings" if kind == "settings" else "numbers"


Table = Annotated[
    Union[Annotated[SettingsTable, Tag("settings")], Annotated[RunTable, Tag("numbers")]], Discriminator(_layout)
]
