"""Figures and tables."""

from typing import Annotated, Literal, Union

from pydantic import Discriminator, Field, Tag, model_validator

from hypernode.config.section import Positive, Section
from hypernode.config.synthetic import LoadKind
from hypernode.tables.limits import MOST_COLUMNS


class RunFigure(Section):
    """A figure of one run."""

    kind: Literal["identification", "anisotropy", "overview", "references"]
    """Its layout."""
    case: str
    """Case of the run."""
    method: str
    """Method of the run, one of its case."""
    step: int = -1
    """Load step drawn, from 0; -1 is the last."""


class ShownRun(Section):
    """A row of a comparison: a run, or what one of its stages left."""

    case: str
    """Case of the run."""
    method: str
    """Method of the run, one of its case."""
    stage: Literal["constrained", "homogenised", "initialised", "pretrained", "material"] = "material"
    """Stage whose field is drawn; the last one where it is left out."""
    label: str
    """Caption of the row."""


class DeformedRun(Section):
    """A row of a figure of deformations."""

    case: str
    """Synthetic case of the run, whose deformation is known."""
    method: str
    """Method of the run, one of its case."""
    label: str
    """Caption of the row."""


class DeformationFigure(Section):
    """A figure of the data of several runs: displacement, strain, and what the deformation gradient misses."""

    kind: Literal["deformation"]
    runs: list[DeformedRun] = Field(min_length=1)
    """The rows, from the top."""
    step: int = -1
    """Load step drawn, from 0; -1 is the last."""


class Comparison(Section):
    """A figure of several runs: their fields, or the fields' errors, at several stretches."""

    kind: Literal["comparison"]
    runs: list[ShownRun] = Field(min_length=1)
    """The rows, from the top."""
    stretches: list[Positive] = Field(min_length=1)
    """The columns: stretches at which the materials are asked."""
    load: LoadKind = "equibiaxial"
    """Mode of deformation in which they are asked."""
    show: Literal["stress", "error"] = "stress"
    """Whether the stress is drawn or its error against the truth."""


class Detection(Section):
    """A figure of many runs of known sheets: which contrasts were told from noise."""

    kind: Literal["detection"]
    runs: list[str] = Field(min_length=1)
    """Patterns of case/method, as file names are matched."""


class PicturesFigure(Section):
    """A figure of a photographed sheet: its pictures and what was read from them."""

    kind: Literal["pictures"]
    case: str
    """Photographed case."""
    step: int = -1
    """Load step drawn, from 0; -1 is the last."""


class ExploredRun(Section):
    """A run of which ``explorer.html`` is written: a page that shows it, and answers at any point of its sheet."""

    case: str
    """Case of the run."""
    method: str
    """Method of the run, one of its case."""
    beside: str | None = None
    """Another method of the case, shown beside it."""


Figure = Annotated[
    Union[RunFigure, Comparison, DeformationFigure, Detection, PicturesFigure], Field(discriminator="kind")
]
#: Kinds of figures that name several runs, one a row.
KINDS_OF_ROWS = ("comparison", "deformation")


class RunTable(Section):
    """Numbers of the runs ``case/method`` that match a pattern, one by one or in groups."""

    kind: Literal["runs", "timing", "validation", "references", "ensemble"] = "runs"
    """Which numbers: scores, seconds of each stage, unseen loads, reference sheets, or how much the fields of the
    runs of each group, which are of one case, differ."""
    runs: list[str] = ["*"]
    """Patterns of case/method, as file names are matched; left out, every run."""
    columns: list[str] = []
    """Names of the columns that are shown; left out, the usual ones of this kind. The CSV file has all of them."""
    groups: dict[str, str] = {}
    """Label -> pattern: one row with mean, spread, median and largest value for each, in the place of single runs."""

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
    """The section."""


def _layout(table) -> str:
    kind = table.get("kind") if isinstance(table, dict) else getattr(table, "kind", None)
    return "settings" if kind == "settings" else "numbers"


Table = Annotated[
    Union[Annotated[SettingsTable, Tag("settings")], Annotated[RunTable, Tag("numbers")]], Discriminator(_layout)
]
