"""The names by which one part of a configuration refers to another."""

from collections.abc import Iterator
from typing import NamedTuple

from hypernode.config.model import Config


class Reference(NamedTuple):
    """A name that the configuration uses: where, which section it should be in, and what there is in it."""

    path: tuple
    name: str
    section: str
    names: list[str]


def unknown_references(config: Config, methods: list[str]) -> Iterator[Reference]:
    """References to what does not exist; ``methods`` may be named by a case."""
    for name, case in config.cases.items():
        yield from _of_case(config, name, case, methods)
    for name, figure in config.figures.items():
        shown = [(("figures", name), figure)]
        if figure.kind == "comparison":
            shown = [(("figures", name, "runs", index), run) for index, run in enumerate(figure.runs)]
        for at, run in shown:
            if run.case not in config.cases:
                yield Reference((*at, "case"), run.case, "cases", list(config.cases))
            elif run.method not in config.cases[run.case].methods:
                yield Reference((*at, "method"), run.method, "methods of its case", config.cases[run.case].methods)


def _of_case(config: Config, name: str, case, methods: list[str]) -> Iterator[Reference]:
    sections = {
        "geometries": list(config.geometries),
        "materials": list(config.materials),
        "loads": list(config.loads),
        "noise": list(config.noise),
        "specimens": list(config.specimens),
        "methods": methods,
        "specimens that are cases": [other for other, each in config.cases.items() if each.specimen],
    }
    used = [
        *((("geometry",), case.geometry, "geometries"), (("hole",), case.hole, "geometries")),
        *((("inclusion",), case.inclusion, "materials"), (("matrix",), case.matrix, "materials")),
        *((("noise",), case.noise, "noise"), (("specimen",), case.specimen, "specimens")),
        *((("layers", k, "geometry"), layer.geometry, "geometries") for k, layer in enumerate(case.layers)),
        *((("layers", k, "material"), layer.material, "materials") for k, layer in enumerate(case.layers)),
        *((("loads", k), value, "loads") for k, value in enumerate(case.loads)),
        *((("unseen_loads", k), value, "loads") for k, value in enumerate(case.unseen_loads)),
        *((("references", k), value, "specimens that are cases") for k, value in case.references.items()),
        *((("methods", k), value, "methods") for k, value in enumerate(case.methods)),
    ]
    for path, value, section in used:
        if value is not None and value not in sections[section]:
            yield Reference(("cases", name, *path), value, section, sections[section])
