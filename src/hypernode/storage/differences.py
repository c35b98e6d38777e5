"""What differs between two runs, and by how much."""

from pathlib import Path

import numpy as np

from hypernode.storage.netcdf import read
from hypernode.storage.records import read_record, result_files


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
        One entry a file that differs: its name, and lines for configuration, code, versions, compiler, processor,
        inputs and numbers, in that order.
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
        for key in ("versions", "compiler", "processor"):
            lines += [f"{key}: {line}" for line in _settings(one.get(key, {}), other.get(key, {}))]
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
