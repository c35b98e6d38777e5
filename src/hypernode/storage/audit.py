"""Where a result came from, whether it is intact, and what differs between two runs."""

import json
from pathlib import Path

import numpy as np

from hypernode.storage.netcdf import read
from hypernode.storage.records import StorageError, is_record, read_record, record_of, sha256

#: Folders of a run that hold no results: what a job said and how long it took.
NOT_RESULTS = ("logs", "benchmarks")


def result_files(folder: Path) -> list[Path]:
    """Every result file of a run, without records, logs and benchmarks, in a fixed order."""
    return sorted(
        path
        for path in folder.rglob("*")
        if path.is_file() and path.relative_to(folder).parts[0] not in NOT_RESULTS and not is_record(path)
    )


def problems_of(path: Path) -> list[str]:
    """What is wrong with one result file, its record and its parents; one line each."""
    try:
        record = read_record(path)
    except StorageError as error:
        return [str(error)]
    found = []
    if record["sha256"] != sha256(path):
        found.append(f"{path}: its SHA-256 is not the recorded one: damaged or changed")
    for parent, digest in record["parents"].items():
        place = path.parent / parent
        if not place.is_file():
            found.append(f"{path}: its parent {parent} is gone")
        elif sha256(place) != digest:
            found.append(f"{path}: its parent {parent} is not the file it was computed from")
    for raw, digest in record["raw_inputs"].items():
        if Path(raw).is_file() and sha256(raw) != digest:
            found.append(f"{path}: the raw input {raw} has changed since")
    if path.suffix == ".nc" and not found:
        try:
            inside = json.loads(read(path).attrs["parents"])
        except (StorageError, KeyError, ValueError) as error:
            return [*found, str(error)]
        if inside != record["parents"]:
            found.append(f"{record_of(path)}: names other parents than the file itself: the record was changed")
    return found


def verify(folder: Path) -> list[str]:
    """Rehash every file of a run and of its ancestry; one line a problem, none where all is well.

    Raises:
        StorageError: there is no such folder, or nothing in it.
    """
    files = result_files(folder) if folder.is_dir() else []
    if not files:
        raise StorageError(f"{folder}: no results there; give the results folder of a run")
    orphans = [
        f"{record}: a record without its file"
        for record in sorted(folder.rglob("*.json"))
        if record.relative_to(folder).parts[0] not in NOT_RESULTS
        and is_record(record)
        and not record.with_suffix("").is_file()
    ]
    return [problem for path in files for problem in problems_of(path)] + orphans


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
    for seed in seeds(node["settings"]):
        lines.append(f"{indent}  {seed}")
    lines.append(f"{indent}  versions {', '.join(f'{k} {v}' for k, v in sorted(node['versions'].items()))}")
    for raw, digest in sorted(node["raw_inputs"].items()):
        lines.append(f"{indent}  raw input {raw}, sha256 {digest[:12]}")
    for parent in node["parents"]:
        lines += tree(parent, root, indent + "    ", seen)
    return lines


def _numbers(a: Path, b: Path) -> list[str]:
    """How the variables of two NetCDF files differ."""
    one, other = read(a), read(b)
    lines = []
    for name in sorted(set(one.variables) | set(other.variables)):
        if name not in one or name not in other:
            lines.append(f"{name}: only in {'the second' if name not in one else 'the first'}")
            continue
        x, y = one[name].values, other[name].values
        if x.shape != y.shape:
            lines.append(f"{name}: shape {x.shape} against {y.shape}")
        elif not np.array_equal(x, y, equal_nan=x.dtype.kind == "f"):
            scale = float(np.nanmax(np.abs(x))) or 1.0
            difference = float(np.nanmax(np.abs(np.asarray(x, float) - np.asarray(y, float))))
            lines.append(f"{name}: largest difference {difference:.3g}, {difference / scale:.3g} of the largest value")
    return lines


def _depth(path: Path) -> int:
    record = read_record(path)
    return 1 + max((_depth((path.parent / parent).resolve()) for parent in record["parents"]), default=0)


def compare(a: Path, b: Path) -> list[dict]:
    """What differs between two runs, the earliest stage first.

    Returns:
        One entry a file that differs: its name, and lines for configuration, code, versions, inputs and
        numbers, in that order.
    """
    files = {path.relative_to(a): path for path in result_files(a)}
    others = {path.relative_to(b): path for path in result_files(b)}
    entries = [
        {"file": str(name), "differences": [f"only in {a if name in files else b}"], "depth": 0}
        for name in sorted(set(files) ^ set(others))
    ]
    for name in sorted(set(files) & set(others)):
        one, other = read_record(files[name]), read_record(others[name])
        if one["sha256"] == other["sha256"]:
            continue
        lines = [f"configuration: {line}" for line in _settings(one["settings"], other["settings"])]
        if one["code"] != other["code"]:
            lines.append(f"code: {one['code'][:12]} against {other['code'][:12]}")
        for package in sorted(set(one["versions"]) | set(other["versions"])):
            versions = one["versions"].get(package), other["versions"].get(package)
            if versions[0] != versions[1]:
                lines.append(f"version of {package}: {versions[0]} against {versions[1]}")
        for key in ("raw_inputs", "parents"):
            for parent in sorted(set(one[key]) | set(other[key])):
                if one[key].get(parent) != other[key].get(parent):
                    lines.append(f"input {parent} differs")
        if name.suffix == ".nc":
            lines += [f"numbers: {line}" for line in _numbers(files[name], others[name])]
        entries.append({"file": str(name), "differences": lines or ["bytes only"], "depth": _depth(files[name])})
    entries.sort(key=lambda entry: (entry["depth"], entry["file"]))
    return entries


def _settings(one, other, path: str = "") -> list[str]:
    if isinstance(one, dict) and isinstance(other, dict):
        keys = sorted(set(one) | set(other))
        return [line for key in keys for line in _settings(one.get(key), other.get(key), f"{path}.{key}".strip("."))]
    return [] if one == other else [f"{path} = {one!r} against {other!r}"]
