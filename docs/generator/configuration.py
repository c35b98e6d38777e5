"""The reference of the configuration, from its JSON Schema."""

import json
from collections.abc import Iterator, Mapping

#: Entries whose keys are those of another entry, all of them optional: what a method says that extends another.
_CHANGED = "Changed"
_BOUNDS = {
    "minimum": "at least {}",
    "exclusiveMinimum": "above {}",
    "maximum": "at most {}",
    "exclusiveMaximum": "below {}",
}
_NAMES = {
    "string": "text",
    "number": "number",
    "integer": "whole number",
    "boolean": "true or false",
    "null": "null",
    "object": "mapping",
    "array": "list",
}


def page(schema: Mapping) -> str:
    """The page in MyST Markdown.

    Args:
        schema: what ``hypernode schema config`` prints.
    """
    lines = [
        "# Configuration reference",
        "",
        "Every key that a configuration may have, as `hypernode schema config` knows them.",
        "[The guide](../../config/README.md) shows the keys at work.",
        "",
    ]
    for name, section in schema["properties"].items():
        lines += [f"## {name}", "", section.get("description", ""), ""]
        kind = "A list. Each entry" if section.get("type") == "array" else "A mapping from names to entries. An entry"
        links = list(dict.fromkeys(_link(each) for each in _references(section) if not each.startswith(_CHANGED)))
        lines += [f"{kind} is {_or(links)}.", ""] if links else []
    lines += ["## Entries", ""]
    for name, entry in schema["$defs"].items():
        if not name.startswith(_CHANGED):
            lines += _entry(name, entry)
    return "\n".join(lines) + "\n"


def _entry(name: str, entry: Mapping) -> list[str]:
    description = entry.get("description", "").replace("``", "`")
    lines = [f"({_anchor(name)})=", "", f"### {name}", "", description, ""]
    lines += ["| key | what it may be | default | meaning |", "|---|---|---|---|"]
    required = entry.get("required", ())
    for key, value in entry.get("properties", {}).items():
        default = "must be given" if key in required or "default" not in value else f"`{_yaml(value['default'])}`"
        meaning = " ".join(value.get("description", "").replace("``", "`").split())
        lines.append(f"| `{key}` | {_type(value)} | {default} | {_cell(meaning)} |")
    if isinstance(entry.get("additionalProperties"), Mapping) or entry.get("additionalProperties") is True:
        lines.append("| other keys | | | as the description says |")
    return [*lines, ""]


def _anchor(name: str) -> str:
    return f"config-{name.lower()}"


def _link(name: str) -> str:
    return f"[{name}](#{_anchor(name)})"


def _references(value) -> Iterator[str]:
    """Names of the entries that a part of the schema refers to."""
    if isinstance(value, Mapping):
        if "$ref" in value:
            yield value["$ref"].rsplit("/", 1)[-1]
        for key, each in value.items():
            if key != "discriminator":
                yield from _references(each)
    elif isinstance(value, list):
        for each in value:
            yield from _references(each)


def _type(value: Mapping) -> str:
    """What a value may be, in words."""
    if "$ref" in value:
        return _link(value["$ref"].rsplit("/", 1)[-1].removeprefix(_CHANGED))
    if "const" in value:
        return f"`{_yaml(value['const'])}`"
    if "enum" in value:
        return _or([f"`{_yaml(each)}`" for each in value["enum"]])
    for several in ("anyOf", "oneOf"):
        if several in value:
            return _or(list(dict.fromkeys(map(_type, value[several]))))
    kind = value.get("type")
    if kind == "array":
        return _list(value)
    if kind == "object":
        inner = value.get("additionalProperties")
        return f"mapping to {_type(inner)}" if isinstance(inner, Mapping) and inner else "mapping"
    words = _or([_NAMES[each] for each in kind]) if isinstance(kind, list) else _NAMES.get(kind, "anything")
    bounds = [text.format(f"{value[key]:g}") for key, text in _BOUNDS.items() if key in value]
    return f"{words} {' and '.join(bounds)}".strip()


def _list(value: Mapping) -> str:
    if "prefixItems" in value:
        inner = list(dict.fromkeys(map(_type, value["prefixItems"])))
        return f"list of {len(value['prefixItems'])}: {', '.join(inner)}"
    return f"list of {_type(value['items'])}" if value.get("items") else "list"


def _or(words: list[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} or {words[-1]}"


def _yaml(value) -> str:
    """A value as it may be written in YAML."""
    return value if isinstance(value, str) and value else json.dumps(value, ensure_ascii=False)


def _cell(text: str) -> str:
    return text.replace("|", "\\|")
