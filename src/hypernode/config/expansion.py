"""What a configuration need not write out: cases of grid blocks and of specimens, and what is shown of those."""

import itertools
from collections.abc import Callable

from hypernode.config.cases import Case, Grid, Sheet
from hypernode.config.errors import ConfigError
from hypernode.config.model import Config
from hypernode.config.outputs import ExploredRun, RunFigure
from hypernode.config.section import NAME


def all_cases(config: Config, where: Callable[..., str]) -> dict[str, Case]:
    """The written cases, those of the grid blocks, and one for each specimen that no case names.

    Raises:
        ConfigError: two of them have the same name, or one has a name that no file could have.
    """
    cases = dict(config.cases)
    for index, grid in enumerate(config.grid):
        at = f"{where('grid', index)}: grid.{index}"
        try:
            block = expanded(grid)
        except ValueError as error:
            raise ConfigError(f"{at}: {error}") from None
        for name in block:
            if name in cases:
                raise ConfigError(f"{at}: it makes a case '{name}', which exists already")
            if not NAME.match(name):
                raise ConfigError(f"{at}: '{name}' is no valid case name")
        cases |= block
    named = {case.specimen for case in cases.values()}
    unnamed = [name for name in config.specimens if name not in named]
    for name in unnamed:
        if name in cases:
            raise ConfigError(
                f"{where('specimens', name)}: specimens.{name}: no case names it, and the case of its name is another "
                f"one: add a case with 'specimen: {name}'"
            )
    return cases | {name: Case(specimen=name) for name in unnamed}


def specimen_figures(cases: dict[str, Case]) -> dict[str, RunFigure]:
    """One figure of the identification for every run of a specimen."""
    return {
        f"{name}_{method}": RunFigure(kind="identification", case=name, method=method)
        for name, case in cases.items()
        if case.specimen
        for method in case.methods
    }


def specimen_explorers(cases: dict[str, Case]) -> list[ExploredRun]:
    """An explorer of every run of a specimen."""
    return [
        ExploredRun(case=name, method=method)
        for name, case in cases.items()
        if case.specimen
        for method in case.methods
    ]


def expanded(grid: Grid) -> dict[str, Case]:
    """The cases of a grid block by their names.

    Raises:
        ValueError: the template of the names gives one twice, or refers to what is not swept.
    """
    swept = {
        key: value if isinstance(value, list) else [value]
        for key in ("geometry", "inclusion", "matrix", "noise")
        if (value := getattr(grid, key)) is not None
    }
    cases = {}
    for combination in itertools.product(*swept.values()):
        chosen = dict(zip(swept, combination, strict=True))
        said = {key: getattr(grid, key) for key in Sheet.model_fields}
        shared = {key: value for key, value in said.items() if value != Sheet.model_fields[key].default}
        try:
            name = grid.name.format(**chosen)
        except (KeyError, IndexError, AttributeError) as error:
            raise ValueError(f"the name '{grid.name}' refers to {error}; allowed are {', '.join(swept)}") from None
        if name in cases:
            raise ValueError(f"the name '{grid.name}' gives '{name}' twice; put every swept key into it")
        cases[name] = Case(**chosen, **shared)
    return cases
