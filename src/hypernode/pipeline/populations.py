"""How the sheets of a population are dealt out to jobs, and what each job uses of the configuration."""

from collections.abc import Callable
from functools import cached_property

from hypernode.config.cases import Sheet
from hypernode.config.model import Config
from hypernode.config.populations import group_of, population_config
from hypernode.config.slices import in_fixed_order, slice_for
from hypernode.pipeline.resources import NEEDS, case_size

#: What a sheet is made from.
_SECTIONS, _SWEPT = ("geometries", "materials", "loads", "noise"), ("geometry", "inclusion", "matrix", "noise")


class PlannedPopulation:
    """The sheets of one population by the jobs that identify them.

    A job has sheets of one group, which differ in their noise alone: a further seed changes the last job of each group,
    and a further shape or material none.

    Args:
        config: the whole configuration.
        name: of the population.
    """

    def __init__(self, config: Config, name: str):
        self.name, self.config = name, population_config(config, name)
        self.most = config.populations[name].batch

    @cached_property
    def batches(self) -> dict[str, list[str]]:
        """Name of a batch -> its sheets."""
        groups: dict[tuple[str, ...], list[str]] = {}
        for name, case in self.config.cases.items():
            groups.setdefault(group_of(case), []).append(name)
        return {
            f"{'_'.join(group)}.{number:04d}": names[number * self.most : (number + 1) * self.most]
            for group, names in groups.items()
            for number in range(-(-len(names) // self.most))
        }

    @property
    def folders(self) -> list[str]:
        """The folder of every batch."""
        return [f"results/populations/{self.name}/{batch}" for batch in self.batches]

    @property
    def outputs(self) -> list[str]:
        """The collection of all sheets and its tables."""
        return [f"results/populations/{self.name}.{kind}" for kind in ("nc", "csv", "md", "tex")]

    def settings(self, batch: str) -> dict:
        """What a job uses of the configuration, for its ``params``: what its sheets share stands there once."""
        names = self.batches[batch]
        whole: dict = {}
        for name in names:
            for section, entries in sheet_settings(self.config, name).items():
                whole.setdefault(section, {}).update(entries)
        return in_fixed_order(whole)

    def memory(self, batch: str, attempt: int) -> int:
        """Memory of a job [MB]: its sheets come one after the other."""
        return NEEDS["population_batch"].megabytes(self._size(batch), attempt)

    def runtime(self, batch: str, attempt: int) -> int:
        """Time of a job [minutes]."""
        need, size, count = NEEDS["population_batch"], self._size(batch), len(self.batches[batch])
        return round(attempt * (need.minutes + count * need.minutes_a_sheet(size)))

    def _size(self, batch: str):
        return case_size(self.config, self.batches[batch][0])


def sheet_settings(config: Config, name: str) -> dict:
    """What one sheet of a population is made and identified from, its method included."""
    method = config.cases[name].methods[0]
    return {
        **slice_for(config, name, _SECTIONS, (*_SWEPT, *Sheet.model_fields)),
        "methods": {method: config.methods[method].model_dump(mode="json", exclude_defaults=True)},
    }


def planned_populations(config: Config) -> dict[str, PlannedPopulation]:
    """Every population of a configuration."""
    return {name: PlannedPopulation(config, name) for name in config.populations}


def for_batch(populations: dict[str, PlannedPopulation], what: str) -> Callable:
    """A resource of a job, as a function of its wildcards and of the attempt."""
    return lambda wildcards, attempt: getattr(populations[wildcards.population], what)(wildcards.batch, attempt)
