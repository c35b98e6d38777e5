"""The names by which one part of a configuration refers to another."""

from collections.abc import Iterator
from typing import NamedTuple

from hypernode.config.model import Config
from hypernode.config.outputs import KINDS_OF_ROWS
from hypernode.tables.columns import COLUMNS

#: Keys of a case, and of a layer, that name an entry of a section.
_SECTION = {
    "geometry": "geometries",
    "hole": "geometries",
    "inclusion": "materials",
    "matrix": "materials",
    "noise": "noise",
    "specimen": "specimens",
}
_SECTION_OF_PHASE = {"geometry": "geometries", "material": "materials"}


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
        shown = [] if figure.kind == "detection" else [(("figures", name), figure)]
        if figure.kind in KINDS_OF_ROWS:
            shown = [(("figures", name, "runs", index), run) for index, run in enumerate(figure.runs)]
        for at, run in shown:
            if run.case not in config.cases:
                yield Reference((*at, "case"), run.case, "cases", list(config.cases))
            elif figure.kind != "pictures" and run.method not in config.cases[run.case].methods:
                yield Reference((*at, "method"), run.method, "methods of its case", config.cases[run.case].methods)
    for index, run in enumerate(config.explorers):
        for key, value in (("case", run.case), ("method", run.method), ("beside", run.beside)):
            names, section = list(config.cases), "cases"
            if key != "case":
                names, section = config.cases[run.case].methods, "methods of its case"
            if value is not None and value not in names:
                yield Reference(("explorers", index, key), value, section, names)
                break
    for name, table in config.tables.items():
        for index, column in enumerate(getattr(table, "columns", [])):
            if column not in COLUMNS[table.kind]:
                yield Reference(
                    ("tables", name, "columns", index), column, f"columns of {table.kind}", list(COLUMNS[table.kind])
                )


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
        *(((key,), getattr(case, key), section) for key, section in _SECTION.items()),
        *(
            (("further_phases", k, key), getattr(phase, key), _SECTION_OF_PHASE[key])
            for k, phase in enumerate(case.further_phases)
            for key in _SECTION_OF_PHASE
        ),
        *(
            ((key, k), value, "loads")
            for key in ("loads", "unseen_loads")
            for k, value in enumerate(getattr(case, key))
        ),
        *((("references", phase), value, "specimens that are cases") for phase, value in case.references.items()),
        *((("methods", k), value, "methods") for k, value in enumerate(case.methods)),
    ]
    for path, value, section in used:
        if value is not None and value not in sections[section]:
            yield Reference(("cases", name, *path), value, section, sections[section])
