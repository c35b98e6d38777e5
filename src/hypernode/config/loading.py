"""From files to a checked configuration, with errors that say where, what and how to mend it before any job starts."""

import math
from pathlib import Path

from pydantic import ValidationError

from hypernode.config.cases import Case
from hypernode.config.errors import ConfigError
from hypernode.config.expansion import all_cases, specimen_explorers, specimen_figures
from hypernode.config.model import Config
from hypernode.config.populations import check_populations
from hypernode.config.presets import lineage, presets, resolved_methods
from hypernode.config.problems import describe, near, written_path
from hypernode.config.references import unknown_references
from hypernode.config.section import NAME
from hypernode.config.sources import Source, Sources, read_yaml
from hypernode.config.specimens import Specimen
from hypernode.config.synthetic import Noise
from hypernode.mechanics.loads import make_load

__all__ = ["ConfigError", "check_config", "load_config"]


def load_config(*paths: str | Path, overrides: dict | None = None) -> Config:
    """Read and check a configuration.

    Args:
        paths: YAML files, each laid over those before it.
        overrides: sections laid over them all, from ``--config`` of the command line.

    Returns:
        The configuration with every grid block expanded into its cases, and with the presets that cases name.

    Raises:
        ConfigError: a file cannot be read, is not YAML, or breaks the schema. The message names
            the file, the line, the key path, the value and what is allowed, one error a paragraph.
    """
    sources = [read_yaml(path) for path in paths]
    if overrides:
        sources.append(Source("--config", overrides))
    return _checked(Sources(tuple(sources)))


def check_config(raw, source: str = "config") -> Config:
    """Check a parsed configuration; see :func:`load_config`."""
    return _checked(Sources((Source(str(source), raw),)))


def _checked(sources: Sources) -> Config:
    try:
        raw = sources.merged()
        _check_names(raw, sources)
        written = raw.get("methods", {})
        if isinstance(written, dict):
            raw = {**raw, "methods": resolved_methods(written, presets(), sources.where)}
    except RecursionError:
        raise ConfigError(f"{sources.parts[0].name}: an anchor holds itself") from None
    config = _validated(raw, sources)
    cases = all_cases(config, sources.where)
    if not cases and not config.populations:
        raise ConfigError(
            f"{sources.parts[-1].name}: there is no case: add one under 'cases', 'grid', 'specimens' or 'populations'"
        )
    named = {method for case in (*cases.values(), *config.populations.values()) for method in case.methods}
    shipped = {name: preset for name, preset in presets().items() if name in named - config.methods.keys()}
    config = config.model_copy(
        update={
            "cases": cases,
            "methods": Config.model_validate({"methods": shipped}).methods | config.methods,
            "figures": config.figures if "figures" in raw else specimen_figures(cases),
            "explorers": config.explorers if "explorers" in raw else specimen_explorers(cases),
        }
    )
    _check_meaning(config, sources)
    return config


def _check_names(raw: dict, sources: Sources) -> None:
    problems = [
        f"{sources.where(section, name)}: {section}.{name}: names use letters, digits, "
        "'_', '-' and '.', and start with a letter or digit"
        for section, entries in raw.items()
        if isinstance(entries, dict)
        for name in entries
        if not (isinstance(name, str) and NAME.match(name))
    ]
    if problems:
        raise ConfigError("\n".join(problems))


def _validated(raw: dict, sources: Sources) -> Config:
    """The configuration as it is written, checked against the schema; what a method inherits is at fault only once."""
    try:
        return Config.model_validate(raw)
    except ValidationError as failed:
        problems = []
        for error in failed.errors():
            path = tuple(written_path(error))
            paths = [path]
            if path[:1] == ("methods",) and len(path) > 2:
                methods = sources.merged()["methods"]
                paths = [("methods", name, *path[2:]) for name in lineage(path[1], methods)]
            found, where = sources.place(*paths)
            if found == path:
                problems.append(describe(error, where))
        raise ConfigError("\n".join(problems)) from None


def _check_meaning(config: Config, sources: Sources) -> None:
    """Check what the schema cannot: names that refer to something, files that exist, cases that can be run."""
    allowed = list(dict.fromkeys((*config.methods, *presets())))
    for path, name, section, names in unknown_references(config, allowed):
        at = ".".join(map(str, path))
        hint = f"{near(name, names)}\n    allowed: {', '.join(names) or '(none)'}"
        raise ConfigError(f"{sources.where(*path)}: {at} = {name!r}: no such entry in {section}{hint}")
    for name, figure in config.figures.items():
        if figure.kind == "pictures" and not config.cases[figure.case].photographed:
            where = sources.where("figures", name, "case")
            raise ConfigError(f"{where}: figures.{name}.case = {figure.case!r}: its camera takes no pictures")
    for name, geometry in config.geometries.items():
        if geometry.shape == "image" and not Path(geometry.path).is_file():
            where = sources.where("geometries", name, "path")
            raise ConfigError(f"{where}: geometries.{name}.path = {geometry.path!r}: no such file")
    for name, specimen in config.specimens.items():
        _check_folders(name, specimen, sources)
        if specimen.thickness_map and not Path(specimen.thickness_map).is_file():
            where = sources.where("specimens", name, "thickness_map")
            raise ConfigError(f"{where}: specimens.{name}.thickness_map = {specimen.thickness_map!r}: no such file")
    check_populations(config, sources.where)
    # A sheet that others are compared with needs none.
    compared = {other for case in config.cases.values() for other in case.references.values()}
    for name, case in config.cases.items():
        where = f"{sources.where('cases', name)}: cases.{name}"
        if not case.methods and name not in compared:
            raise ConfigError(f"{where}.methods: list at least one method ({', '.join(allowed)})")
        if case.inclusion is None and not case.specimen and config.geometries[case.geometry].shape != "uniform":
            raise ConfigError(f"{where}: the geometry '{case.geometry}' needs an inclusion material")
        if case.photographed:
            _check_photographed(config, case, where)
        if case.specimen and config.specimens[case.specimen].thickness_map:
            _check_thickness(config, case.methods, where)
        if case.specimen and config.specimens[case.specimen].plane == "strain":
            _check_plane(config, case.methods, where)


def _check_folders(name: str, specimen: Specimen, sources: Sources) -> None:
    """Refuse folders that are absent where they may not be."""
    for number, test in enumerate(specimen.all_tests):
        if specimen.optional or Path(test.folder).is_dir():
            continue
        path = ("specimens", name, *(("tests", number) if specimen.tests else ()), "folder")
        source = f" (published in {specimen.published_at})" if specimen.published_at else ""
        raise ConfigError(
            f"{sources.where(*path)}: {'.'.join(map(str, path))} = {test.folder!r}: no such folder: put the specimen's "
            f"files there{source}, or say 'optional: true' to leave it out where they are absent"
        )


def _check_photographed(config: Config, case: Case, where: str) -> None:
    """Refuse errors of displacements where pictures have their own, and motions that nobody looks for."""
    noise, camera = config.noise.get(case.noise, Noise()), case.camera
    for key in ("sigma", "outliers"):
        if getattr(noise, key):
            raise ConfigError(
                f"{where}.noise: {case.noise} has {key} = {getattr(noise, key):g}, and the displacements of a "
                "photographed sheet have the errors of its pictures: set camera.pictures.noise, and leave errors of "
                "forces alone here"
            )
    if noise.repeats > 1:
        raise ConfigError(
            f"{where}.noise: {case.noise} has {noise.repeats} repeats, and a photographed sheet is tested once"
        )
    if camera.correlated.incremental:
        return
    pixel = camera.pixel_size(case.size)
    sides = [side / pixel for side in case.size]
    loads = [make_load(config.loads[key].kind, config.loads[key].stretches) for key in case.loads]
    # The camera follows the middle.
    furthest = 0.5 * max(float((abs(load.H) @ sides).max()) for load in loads)
    if furthest > camera.correlated.reach:
        raise ConfigError(
            f"{where}.camera.correlation.reach = {camera.correlated.reach}: a corner of the sheet moves by "
            f"{furthest:.0f} pixels: set reach to {math.ceil(round(furthest, 6))} or more, or incremental: true"
        )


def _check_thickness(config: Config, methods: list[str], where: str) -> None:
    """Refuse methods whose equilibrium is that of a sheet of one thickness."""
    for name in methods:
        method = config.methods[name]
        if method.baseline or method.training.iterations or method.constrained is None:
            raise ConfigError(
                f"{where}.methods: {name} takes the sheet as everywhere of one thickness: leave out thickness_map, or "
                "choose a method with a constrained field and without training"
            )


def _check_plane(config: Config, methods: list[str], where: str) -> None:
    """Refuse methods whose sheet becomes thinner as its area grows, where its thickness stays."""
    for name in methods:
        field = config.methods[name].constrained
        if field is None or "J" not in field.terms:
            raise ConfigError(
                f"{where}.methods: {name} has a law of a thin sheet that keeps its volume, and the specimen says "
                "plane: strain; take hypernode_compressible, or a method whose constrained.terms have J"
            )
