"""Where a result came from: its record, those of its parents, and so on to the raw inputs."""

import json
from pathlib import Path

from hypernode.storage.errors import StorageError
from hypernode.storage.records import read_record


def lineage(path: Path) -> dict:
    """The record of a file with the records of its ancestors in place of its parents' digests.

    Raises:
        StorageError: the file or one of its ancestors has no intact record.
    """
    if not path.is_file():
        raise StorageError(f"{path}: no such file")
    record = read_record(path)
    parents = [lineage((path.parent / parent).resolve()) for parent in sorted(record["parents"])]
    return {"file": str(path), **record, "parents": parents}


def seeds(settings) -> list[str]:
    """Every ``seed`` in nested settings, as ``key = value``."""
    if not isinstance(settings, dict):
        return []
    found = [f"{key} = {value}" for key, value in settings.items() if key == "seed"]
    return found + [seed for value in settings.values() for seed in seeds(value)]


def tree(node: dict, root: Path, indent: str = "", seen: set | None = None) -> list[str]:
    """Lines that show a lineage as a tree; an ancestor met before is named but not repeated."""
    seen = set() if seen is None else seen
    name = Path(node["file"])
    shown = str(name.relative_to(root)) if name.is_relative_to(root) else str(name)
    if node["file"] in seen:
        return [f"{indent}{shown} (see above)"]
    seen.add(node["file"])
    source = node.get("source") or {}
    dirty = f" + changes {source['uncommitted'][:12]}" if source.get("uncommitted") else ""
    lines = [f"{indent}{shown}"]
    lines.append(f"{indent}  rule {node['rule']}, code {node['code'][:12]}, sha256 {node['sha256'][:12]}")
    if source:
        lines.append(f"{indent}  commit {source['commit'][:12]}{dirty}, written {node['written']} on {node['host']}")
    lines.append(f"{indent}  settings {json.dumps(node['settings'], sort_keys=True)}")
    lines += [f"{indent}  {seed}" for seed in seeds(node["settings"])]
    lines.append(f"{indent}  versions {', '.join(f'{k} {v}' for k, v in sorted(node['versions'].items()))}")
    for name, value in sorted(node.get("compiler", {}).items()):
        lines.append(f"{indent}  {name} = {value}")
    for raw, digest in sorted(node["raw_inputs"].items()):
        lines.append(f"{indent}  raw input {raw}, sha256 {digest[:12]}")
    for parent in node["parents"]:
        lines += tree(parent, root, indent + "    ", seen)
    return lines
