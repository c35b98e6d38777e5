"""One sentence for each thing that is wrong: where, which value, what is allowed and what was probably meant."""

import difflib
import re
from collections.abc import Iterable
from types import UnionType
from typing import Union, get_args, get_origin

from pydantic import BaseModel

from hypernode.config.model import Config

#: Key of an older version -> the key that has taken its place.
RENAMED = {"draws": "posterior_samples", "jump_weight": "regulariser_weight", "layers": "further_phases"}


def near(value, allowed: Iterable[str]) -> str:
    """The hint at the allowed name that is most like a value; empty where none is."""
    found = difflib.get_close_matches(str(value), [str(name) for name in allowed], 1, cutoff=0.5)
    return f"; did you mean '{found[0]}'?" if found else ""


def written_path(error: dict) -> list:
    """The key path of a validation error as it stands in a file, without what pydantic adds to it."""
    path = [part for part in error["loc"] if not (isinstance(part, str) and part.startswith("function-"))]
    # The tag of a union.
    return [part for i, part in enumerate(path) if not (i == 2 and path[0] in ("geometries", "figures", "tables"))]


def describe(error: dict, where: str) -> str:
    """One validation error of pydantic as 'file:line: path = value: what is wrong, what is allowed'.

    Args:
        error: an entry of ``ValidationError.errors()``.
        where: 'file:line' of what it is about.
    """
    path = written_path(error)
    key = ".".join(str(part) for part in path)
    kind, context = error["type"], error.get("ctx", {})
    if kind == "extra_forbidden":
        names = _allowed_keys(Config, list(error["loc"][:-1]))
        if path[0] == "methods" and len(path) == 3:
            names = ["extends", *names]
        new = RENAMED.get(str(path[-1]))
        hint = f"; it is called '{new}' now" if new in names else near(path[-1], names)
        return f"{where}: {key}: unknown key{hint}\n    allowed: {', '.join(names)}"
    message = error["msg"].removeprefix("Value error, ")
    value = error.get("input")
    shown = f" = {value!r}" if not isinstance(value, (dict, BaseModel)) and kind != "missing" else ""
    if kind in ("literal_error", "union_tag_invalid"):
        allowed = re.findall(r"'([^']*)'", str(context.get("expected", context.get("expected_tags", ""))))
        given = context.get("tag", value)
        at = f"{key}{shown}"
        if kind == "union_tag_invalid":
            at = f"{key}.{context['discriminator'].strip(chr(39))} = {given!r}"
        return f"{where}: {at}: not allowed{near(given, allowed)}\n    allowed: {', '.join(allowed)}"
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
        tag = section.model_fields.get("shape") or section.model_fields.get("kind")
        if tag is not None and part in get_args(tag.annotation):
            return _allowed_keys(section, rest)
        if part in section.model_fields and (annotation is section or get_origin(annotation) in (Union, UnionType)):
            return _allowed_keys(section.model_fields[part].annotation, rest)
    # The name of an entry in a dictionary, or the index in a list: step over it.
    args = get_args(annotation)
    inner = annotation if not args else args[0] if hasattr(annotation, "__metadata__") else args[-1]
    return _allowed_keys(inner, rest)


def _flatten(annotation):
    args = get_args(annotation)
    return [annotation] if not args else [leaf for arg in args for leaf in _flatten(arg)]
