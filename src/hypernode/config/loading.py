"""Reading a configuration, with errors that say where, what and how to mend it before any job starts."""

import difflib
import itertools
import re
from pathlib import Path
from typing import get_args

import yaml
from pydantic import BaseModel, ValidationError

from hypernode.config.cases import Case, Grid
from hypernode.config.model import Config
from hypernode.errors import ExpectedError
from hypernode.tables.columns import COLUMNS

NAME = re.compile(r"^[A-Za-z0-9][A-Za-z0-9_.-]*$")


class ConfigError(ExpectedError, ValueError):
    """The configuration is wrong; the message is complete and needs no traceback."""


def _expand(grid: Grid) -> dict[str, Case]:
    swept = {
        key: value if isinstance(value, list) else [value]
        for key in ("geometry", "inclusion", "matrix", "noise")
        if (value := getattr(grid, key)) is not None
    }
    cases = {}
    for combination in itertools.product(*swept.values()):
        chosen = dict(zip(swept, combination, strict=True))
        shared = {key: getattr(grid, key) for key in ("loads", "methods", "hole", "cells", "size", "spacing", "camera")}
        try:
            name = grid.name.format(**chosen)
        except (KeyError, IndexError, AttributeError) as error:
            raise ValueError(f"the name '{grid.name}' refers to {error}; allowed are {', '.join(swept)}") from None
        if name in cases:
            raise ValueError(f"the name '{grid.name}' gives '{name}' twice; put every swept key into it")
        cases[name] = Case(**chosen, **shared)
    return cases


def _references(config: Config):
    """(path, name, section, names in it) for every name that one part of the config uses of another."""
    specimen_cases = [name for name, case in config.cases.items() if case.specimen]
    for name, case in config.cases.items():
        at = f"cases.{name}"
        for key, section in (
            ("geometry", "geometries"),
            ("hole", "geometries"),
            ("inclusion", "materials"),
            ("matrix", "materials"),
            ("noise", "noise"),
            ("specimen", "specimens"),
        ):
            if getattr(case, key) is not None:
                yield f"{at}.{key}", getattr(case, key), section, getattr(config, section)
        for index, layer in enumerate(case.layers):
            yield f"{at}.layers.{index}.geometry", layer.geometry, "geometries", config.geometries
            yield f"{at}.layers.{index}.material", layer.material, "materials", config.materials
        for index, value in enumerate(case.loads):
            yield f"{at}.loads.{index}", value, "loads", config.loads
        for index, value in enumerate(case.unseen_loads):
            yield f"{at}.unseen_loads.{index}", value, "loads", config.loads
        for phase, value in case.references.items():
            yield f"{at}.references.{phase}", value, "specimens that are cases", specimen_cases
        for index, value in enumerate(case.methods):
            yield f"{at}.methods.{index}", value, "methods", config.methods
    for name, figure in config.figures.items():
        shown = [(f"figures.{name}", figure)]
        if figure.kind == "comparison":
            shown = [(f"figures.{name}.runs.{index}", run) for index, run in enumerate(figure.runs)]
        for at, run in shown:
            yield f"{at}.case", run.case, "cases", config.cases
            if run.case in config.cases:
                yield f"{at}.method", run.method, "methods of its case", config.cases[run.case].methods
    for name, table in config.tables.items():
        for index, column in enumerate(getattr(table, "columns", [])):
            yield f"tables.{name}.columns.{index}", column, f"columns of {table.kind}", COLUMNS[table.kind]


def _near(value, allowed) -> str:
    near = difflib.get_close_matches(str(value), [str(a) for a in allowed], 1, cutoff=0.5)
    return f"; did you mean '{near[0]}'?" if near else ""


class _ConfigLoader(yaml.SafeLoader):
    """Safe YAML that refuses a key written twice, which YAML would silently let the last one win.

    4e5 and 7e-4 are numbers in it, as everywhere but in YAML 1.1, to which numbers have a point and exponents a sign.
    """

    def construct_mapping(self, node, deep=False):
        """The mapping of a node, if no key of its own stands in it twice."""
        seen = set()
        for key_node, _ in node.value:
            # Entries merged in by '<<' come from elsewhere in the file and may be overridden.
            own = node.start_mark.index <= key_node.start_mark.index < node.end_mark.index
            if not own or key_node.tag == "tag:yaml.org,2002:merge":
                continue
            key = self.construct_object(key_node, deep=True)
            if key in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f"the key '{key}' is written twice", key_node.start_mark
                )
            seen.add(key)
        return super().construct_mapping(node, deep)


_ConfigLoader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)[eE][-+]?[0-9]+$"),
    list("-+.0123456789"),
)


def _line(root: yaml.Node | None, path) -> int | None:
    """Line (from 1) of a key path in a parsed YAML document, as deep as the path exists."""
    node, line = root, None
    for part in path:
        if isinstance(node, yaml.MappingNode):
            found = [(k, v) for k, v in node.value if k.value == str(part)]
            if not found:
                break
            line, node = found[0][0].start_mark.line + 1, found[0][1]
        elif isinstance(node, yaml.SequenceNode) and isinstance(part, int) and part < len(node.value):
            node = node.value[part]
            line = node.start_mark.line + 1
    return line


def _describe(error, root, source) -> str:
    """One validation error as 'file:line: path = value: what is wrong, what is allowed'."""
    path = [part for part in error["loc"] if not (isinstance(part, str) and part.startswith("function-"))]
    # Pydantic adds the tag of a union to the path; it is not a key of the file.
    written = [part for i, part in enumerate(path) if not (i == 2 and path[0] == "geometries")]
    line = _line(root, written)
    where = f"{source}:{line}" if line else str(source)
    key = ".".join(str(part) for part in written)
    kind, context = error["type"], error.get("ctx", {})
    if kind == "extra_forbidden":
        names = _allowed_keys(Config, path[:-1])
        return f"{where}: {key}: unknown key{_near(written[-1], names)}\n    allowed: {', '.join(names)}"
    message = error["msg"].removeprefix("Value error, ")
    value = error.get("input")
    shown = f" = {value!r}" if not isinstance(value, (dict, BaseModel)) and kind != "missing" else ""
    if kind in ("literal_error", "union_tag_invalid"):
        allowed = re.findall(r"'([^']*)'", str(context.get("expected", context.get("expected_tags", ""))))
        given = context.get("tag", value)
        at = f"{key}{shown}" if kind == "literal_error" else f"{key}.shape = {given!r}"
        return f"{where}: {at}: not allowed{_near(given, allowed)}\n    allowed: {', '.join(allowed)}"
    if kind == "missing":
        message = "this key is required"
    return f"{where}: {key}{shown}: {message[0].lower() + message[1:]}"


def _allowed_keys(annotation, path) -> list[str]:
    """Keys of the section at ``path`` of the schema, through dictionaries, lists and tagged unions."""
    sections = [a for a in _flatten(annotation) if isinstance(a, type) and issubclass(a, BaseModel)]
    if not path:
        return list(dict.fromkeys(key for section in sections for key in section.model_fields))
    part, rest = path[0], path[1:]
    for section in sections:
        tag = section.model_fields.get("shape")
        if tag is not None and part in get_args(tag.annotation):
            return _allowed_keys(section, rest)
        if part in section.model_fields and annotation is section:
            return _allowed_keys(section.model_fields[part].annotation, rest)
    # The name of an entry in a dictionary, or the index in a list: step over it.
    args = get_args(annotation)
    inner = annotation if not args else args[0] if hasattr(annotation, "__metadata__") else args[-1]
    return _allowed_keys(inner, rest)


def _flatten(annotation):
    args = get_args(annotation)
    return [annotation] if not args else [leaf for arg in args for leaf in _flatten(arg)]


def load_config(path: str | Path) -> Config:
    """Read and check a configuration file.

    Args:
        path: a YAML file.

    Returns:
        The configuration with every grid block expanded into its cases.

    Raises:
        ConfigError: the file cannot be read, is not YAML, or breaks the schema. The message names
            the file, the line, the key path, the value and what is allowed, one error a paragraph.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: cannot be read: {error}") from None
    try:
        raw = yaml.load(text, Loader=_ConfigLoader)  # noqa: S506 - a SafeLoader
        root = yaml.compose(text, Loader=yaml.SafeLoader)
    except (yaml.YAMLError, RecursionError, TypeError, ValueError) as error:
        mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
        line = f":{mark.line + 1}" if mark else ""
        raise ConfigError(f"{path}{line}: not valid YAML: {getattr(error, 'problem', error)}") from None
    return check_config(raw, source=path, root=root)


def check_config(raw, source="config", root=None) -> Config:
    """Check a parsed configuration; see :func:`load_config`."""
    if not isinstance(raw, dict):
        raise ConfigError(f"{source}: the configuration must be a mapping of sections, not {type(raw).__name__}")
    problems = []
    for section, entries in raw.items():
        if isinstance(entries, dict):
            problems += [
                f"{source}:{_line(root, (section, name)) or '?'}: {section}.{name}: names use letters, digits, "
                "'_', '-' and '.', and start with a letter or digit"
                for name in entries
                if not (isinstance(name, str) and NAME.match(name))
            ]
    if problems:
        raise ConfigError("\n".join(problems))
    try:
        config = Config.model_validate(raw)
    except ValidationError as failed:
        raise ConfigError("\n".join(_describe(e, root, source) for e in failed.errors())) from None
    cases = dict(config.cases)
    for index, grid in enumerate(config.grid):
        where = f"{source}:{_line(root, ('grid', index)) or '?'}: grid.{index}"
        try:
            expanded = _expand(grid)
        except ValueError as error:
            raise ConfigError(f"{where}: {error}") from None
        for name in expanded:
            if name in cases:
                raise ConfigError(f"{where}: it makes a case '{name}', which exists already")
            if not NAME.match(name):
                raise ConfigError(f"{where}: '{name}' is no valid case name")
        cases |= expanded
    config = config.model_copy(update={"cases": cases})
    if not cases:
        raise ConfigError(f"{source}: there is no case: add one under 'cases' or 'grid'")
    for at, name, section, names in _references(config):
        if name not in names:
            line = _line(root, at.split("."))
            where = f"{source}:{line}" if line else str(source)
            hint = f"{_near(name, names)}\n    allowed: {', '.join(names) or '(none)'}"
            raise ConfigError(f"{where}: {at} = {name!r}: no such entry in {section}{hint}")
    for name, geometry in config.geometries.items():
        if geometry.shape == "image" and not Path(geometry.path).is_file():
            line = _line(root, ("geometries", name, "path")) or "?"
            raise ConfigError(f"{source}:{line}: geometries.{name}.path = {geometry.path!r}: no such file")
    # A sheet that others are compared with needs none.
    compared = {other for case in cases.values() for other in case.references.values()}
    for name, case in cases.items():
        if not case.methods and name not in compared:
            raise ConfigError(f"{source}: cases.{name}.methods: list at least one method ({', '.join(config.methods)})")
        if case.inclusion is None and not case.specimen and config.geometries[case.geometry].shape != "uniform":
            raise ConfigError(f"{source}: cases.{name}: the geometry '{case.geometry}' needs an inclusion material")
    return config
