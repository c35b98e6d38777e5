"""The whole configuration: sections of named entries, and cases that combine them."""

from typing import Literal, get_args

from pydantic import field_validator, model_validator

from hypernode.config.cases import Case, Grid, Population
from hypernode.config.geometries import Geometry
from hypernode.config.methods import Method
from hypernode.config.outputs import ExploredRun, Figure, RunTable, Table
from hypernode.config.section import Section
from hypernode.config.specimen_tests import SpecimenLoad
from hypernode.config.specimens import Specimen
from hypernode.config.synthetic import Load, LoadKind, Material, Noise
from hypernode.mechanics.loads import CONSTRAINED, RESULTANTS

# Whoever computes a test must say how its outline moves: general tests are measured ones.
assert {*get_args(LoadKind), "general"} == set(CONSTRAINED), "the schema lists every load kind"
assert set(get_args(SpecimenLoad)) <= set(RESULTANTS), "the machine's resultants are known for every load"


class Config(Section):
    """Cases, what they are combined from, and what is drawn and listed of them.

    Once loaded, cases of grid blocks are in ``cases``, and presets that cases name in ``methods``.
    """

    geometries: dict[str, Geometry] = {}
    """Shapes of inclusions, holes and further phases."""
    materials: dict[str, Material] = {}
    """Closed-form materials of synthetic sheets."""
    loads: dict[str, Load] = {}
    """Load cases of synthetic sheets."""
    noise: dict[str, Noise] = {}
    """Measurement errors of synthetic tests."""
    methods: dict[str, Method] = {}
    """Methods beside the presets."""
    specimens: dict[str, Specimen] = {}
    """Real tests. One that no case names is a case of its own name."""
    cases: dict[str, Case] = {}
    """What is identified."""
    grid: list[Grid] = []
    """Products of lists, each of which becomes many cases."""
    populations: dict[str, Population] = {}
    """Products of lists, each of which is one file of many sheets."""
    figures: dict[str, Figure] = {}
    """Figures; left out, one of the identification for every run of a specimen."""
    tables: dict[str, Table] = {}
    """Tables beside ``summary``, which has one row a run."""

    explorers: list[ExploredRun] = []
    """Runs of which an ``explorer.html`` is written; left out, every run of a specimen."""
    platform: Literal["cpu", "cuda"] = "cpu"
    """What networks are trained on; all else is computed on the CPU. For ``cuda`` the environment needs
    ``requirements/gpu.txt``, and the machine such a device."""

    @field_validator("explorers")
    @classmethod
    def _one_for_each_run(cls, explorers):
        runs = [f"{run.case}/{run.method}" for run in explorers]
        twice = next((run for run in runs if runs.count(run) > 1), None)
        if twice:
            raise ValueError(f"{twice} is listed twice, and a run has one explorer; leave it once")
        return explorers

    @model_validator(mode="after")
    def _summary(self):
        self.tables.setdefault("summary", RunTable())
        return self
