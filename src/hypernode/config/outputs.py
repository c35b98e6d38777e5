"""Figures and tables."""

from typing import Annotated, Literal, Union

from pydantic import Field

from hypernode.config.section import Positive, Section
from hypernode.config.synthetic import LoadKind


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


class SettingsTable(Section):
    """A section of the configuration as a table."""

    kind: Literal["settings"]
    section: Literal["materials", "loads", "methods", "noise"]


Table = Union[SettingsTable, RunTable]
