"""The schema of the configuration.

A configuration names geometries, materials, loads, noise levels, methods and specimens; ``cases``
combine them and ``grid`` blocks expand products of them into more cases.
"""

from typing import get_args

from pydantic import model_validator

from hypernode.config.cases import Case, Grid
from hypernode.config.geometries import Geometry
from hypernode.config.methods import Method
from hypernode.config.outputs import Figure, RunTable, Table
from hypernode.config.section import Section
from hypernode.config.specimens import Specimen
from hypernode.config.synthetic import Load, LoadKind, Material, Noise
from hypernode.mechanics.loads import CONSTRAINED

assert set(get_args(LoadKind)) == set(CONSTRAINED), "the schema lists every load kind"


class Config(Section):
    """The whole configuration; cases of grid blocks are in ``cases`` once loaded."""

    geometries: dict[str, Geometry] = {}
    materials: dict[str, Material] = {}
    loads: dict[str, Load] = {}
    noise: dict[str, Noise] = {}
    methods: dict[str, Method] = {}
    specimens: dict[str, Specimen] = {}
    cases: dict[str, Case] = {}
    grid: list[Grid] = []
    figures: dict[str, Figure] = {}
    tables: dict[str, Table] = {}

    @model_validator(mode="after")
    def _summary(self):
        self.tables.setdefault("summary", RunTable())
        return self
