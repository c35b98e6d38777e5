"""What a job of each rule takes of a machine: memory and time, by the size of its sheet (docs/decisions/0028)."""

from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass
from functools import cache

from hypernode.config.model import Config
from hypernode.pipeline.sources import specimen_files

#: Memory of the two Snakemakes that stand above a job of a group on a node, which has to hold them as well [MB].
SNAKEMAKE = 300


@dataclass(frozen=True)
class Size:
    """How large the sheet of a case is: cells of its finest grid, and load steps of all its tests."""

    cells: int
    steps: int


@dataclass(frozen=True)
class Need:
    """Memory and time of a rule: what each job has, and what grows with its sheet.

    Attributes:
        memory: of the smallest sheet, interpreter and compiler [MB].
        a_cell: more for every thousand cells [MB].
        a_state: more for every thousand cells and every load step [MB].
        minutes: of the smallest sheet, compilation with an empty cache.
        minutes_a_state: more for every thousand cells and every load step.
    """

    memory: float
    _: KW_ONLY
    a_cell: float = 0.0
    a_state: float = 0.0
    minutes: float = 5.0
    minutes_a_state: float = 0.1

    def megabytes(self, size: Size, attempt: int = 1) -> int:
        """Memory of a job [MB]; of every further attempt as much again."""
        cells = size.cells / 1000
        grown = cells * (self.a_cell + size.steps * self.a_state)
        return round(attempt * (SNAKEMAKE + self.memory + grown))

    def runtime(self, size: Size, attempt: int = 1) -> int:
        """Time of a job [minutes]; of every further attempt as much again."""
        return round(attempt * (self.minutes + self.minutes_a_sheet(size)))

    def minutes_a_sheet(self, size: Size) -> float:
        """Time of one of many sheets in one job, without what they share [minutes]."""
        return self.minutes_a_state * size.steps * size.cells / 1000


#: Rule -> what it takes on one core: more than any job was measured to take, of memory a quarter, of time twice.
NEEDS = {
    "true_material": Need(400, a_cell=4),
    "forward": Need(500, a_cell=22, minutes_a_state=0.2),
    "measurement": Need(300, a_state=1),
    "import_dic": Need(500, a_state=2),
    # Of photographed sheets, a cell of whose grid is about a hundred pixels.
    "speckle": Need(300, a_cell=5),
    "photograph": Need(400, a_cell=60, a_state=2),
    # The engine, a process of its own, included.
    "correlate": Need(1000, a_cell=60, a_state=5, minutes=10, minutes_a_state=0.5),
    "photographed": Need(500, a_state=2),
    # A factor of the stiffness of every load step is kept, and so are the directions of conjugate gradients.
    "constrained": Need(900, a_state=80, minutes_a_state=1.5),
    "gradient": Need(300, a_state=2),
    "interpolant": Need(600, a_state=5, minutes=15),
    "homogenised": Need(850, a_state=10, minutes=15),
    "initialisation": Need(600, a_state=5, minutes=15),
    "pretraining": Need(1000, a_state=10, minutes=15),
    # The derivative of every cell's forces and stress by a hundred parameters, and factors as of an equilibrium field.
    "polish": Need(1200, a_cell=250, a_state=120, minutes_a_state=1.5),
    "training": Need(800, a_state=5, minutes=30),
    "baseline": Need(600, a_state=20),
    "evaluation": Need(700, a_state=20),
    "validation": Need(800, a_cell=22, minutes_a_state=0.3),
    "references": Need(800, a_cell=22, minutes_a_state=0.3),
    "population_batch": Need(1000, a_state=80, minutes=10, minutes_a_state=1.5),
    "population": Need(500, minutes=30),
    "population_table": Need(500, minutes=30),
    "figure": Need(700, minutes=3),
    "table": Need(300, minutes=3),
    "explorer": Need(900, a_cell=40, minutes=3, minutes_a_state=0),
    "first_page": Need(300, minutes=3),
    "crate": Need(500, minutes=10),
}


@cache
def _lines(path: str) -> int:
    with open(path, "rb") as file:
        return sum(1 for _ in file)


def case_size(config: Config, name: str | None) -> Size:
    """The size of a case's sheet; of a specimen, its points are the lines of a frame. No case has no size."""
    if name is None:
        return Size(0, 0)
    case = config.cases[name]
    if case.specimen:
        specimen = config.specimens[case.specimen]
        steps = sum(test.steps for test in specimen.all_tests)
        return Size(_lines(specimen_files(config, name)[0]), steps)
    cells = max(case.cells[0] * case.cells[1], case.camera.grid_cells(case.size) if case.camera else 0)
    return Size(cells, sum(len(config.loads[load].stretches) for load in case.loads))


def memory(config: Config, rule: str) -> Callable:
    """The memory [MB] that a rule declares, as a function of its wildcards and of the attempt."""
    return lambda wildcards, attempt: NEEDS[rule].megabytes(case_size(config, wildcards.get("case")), attempt)


def runtime(config: Config, rule: str) -> Callable:
    """The time [minutes] that a rule declares, as a function of its wildcards and of the attempt."""
    return lambda wildcards, attempt: NEEDS[rule].runtime(case_size(config, wildcards.get("case")), attempt)
