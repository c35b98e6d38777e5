"""Populations: many synthetic sheets that are written as one product of lists, and checked as such."""

from collections.abc import Callable, Iterator

from hypernode.config.cases import Case, Population
from hypernode.config.errors import ConfigError
from hypernode.config.expansion import expanded
from hypernode.config.model import Config
from hypernode.config.section import NAME


def seeded_name(noise: str, population: Population, seed: int) -> str:
    """The name of one noise with one seed."""
    return noise if population.seeds == 1 else f"{noise}-{seed:04d}"


def population_config(config: Config, name: str) -> Config:
    """The configuration whose cases are the sheets of a population, and whose noise is that of each of their seeds.

    Raises:
        ValueError: its template gives a name twice, or refers to what is not swept.
    """
    population = config.populations[name]
    noise, names = {}, []
    for each in _listed(population.noise):
        for index in range(population.seeds):
            entry = config.noise[each]
            seed = entry.seed + index
            names.append(seeded_name(each, population, seed))
            noise[names[-1]] = entry.model_copy(update={"seed": seed})
    cases = expanded(population.model_copy(update={"noise": names or None}))
    return config.model_copy(update={"cases": cases, "noise": noise, "populations": {}})


def check_populations(config: Config, where: Callable[..., str]) -> None:
    """Check what the schema cannot, at the product and not at each of its sheets.

    Raises:
        ConfigError: a name refers to nothing, a method has networks, or the names of its sheets are of no use.
    """
    for name, population in config.populations.items():
        at = f"populations.{name}"
        for key, value, section in _references(population):
            names = list(getattr(config, section))
            if value not in names:
                raise ConfigError(
                    f"{where('populations', name, key)}: {at}.{key} = {value!r}: no such entry in {section}"
                    f"\n    allowed: {', '.join(names) or '(none)'}"
                )
        method = config.methods[population.methods[0]]
        if method.baseline != "constrained":
            raise ConfigError(
                f"{where('populations', name, 'methods')}: {at}.methods: {population.methods[0]} is no method of a "
                "constrained field alone: name one with baseline: constrained, such as field"
            )
        shapes = [config.geometries[each].shape for each in _listed(population.geometry)]
        if population.inclusion is None and any(shape != "uniform" for shape in shapes):
            raise ConfigError(f"{where('populations', name)}: {at}: its geometries need an inclusion material")
        try:
            cases = population_config(config, name).cases
        except ValueError as error:
            raise ConfigError(f"{where('populations', name)}: {at}: {error}") from None
        if wrong := next((case for case in cases if not NAME.match(case)), None):
            raise ConfigError(f"{where('populations', name, 'name')}: {at}: '{wrong}' is no valid case name")


def _listed(value) -> list:
    return value if isinstance(value, list) else [] if value is None else [value]


def _references(population: Population) -> Iterator[tuple[str, str, str]]:
    """(key, name, section) of everything that a population refers to."""
    sections = {"geometry": "geometries", "inclusion": "materials", "matrix": "materials", "noise": "noise"}
    sections |= {"hole": "geometries", "loads": "loads", "methods": "methods"}
    for key, section in sections.items():
        for value in _listed(getattr(population, key)):
            yield key, value, section


def group_of(case: Case) -> tuple[str, ...]:
    """What sheets of one group have in common: geometry and materials; only noise and its seed differ."""
    return tuple(name for name in (case.geometry, case.inclusion, case.matrix) if name)
