"""The one place that writes and reads data files."""

import contextlib
import glob
import json
import os
import secrets
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
import xarray as xr

from hypernode.storage.records import StorageError, check_digest, make_record, record_of, sha256
from hypernode.storage.schema import SCHEMA_VERSION, VARIABLES

#: Units of a synthetic test of unit thickness.
SYNTHETIC_UNITS = {"length": "1", "stress": "Pa", "force": "Pa", "energy": "Pa"}
#: Units of a real test, and of a synthetic one with a thickness.
EXPERIMENT_UNITS = {"length": "mm", "stress": "MPa", "force": "N", "energy": "MPa"}


def sheet_units(thickness: float | None) -> dict[str, str]:
    """Units of a synthetic sheet: those of a real one where it has a thickness [mm]."""
    return EXPERIMENT_UNITS if thickness else SYNTHETIC_UNITS


def check_schema(dataset: xr.Dataset, where: str = "dataset") -> None:
    """Check names and dimensions against the schema.

    Raises:
        StorageError: a variable is unknown, has other dimensions than the schema says, or holds an
            infinity.
    """
    for name, variable in dataset.variables.items():
        if "." in name:
            continue
        if name not in VARIABLES:
            raise StorageError(f"{where}: variable '{name}' is not in the storage schema")
        wanted = VARIABLES[name].dims
        if variable.dims[:1] == ("sheet",) != wanted[:1]:
            wanted = ("sheet", *wanted)
        if tuple(variable.dims) != wanted:
            raise StorageError(f"{where}: {name}: dimensions {variable.dims}, the schema says {wanted}")
        if variable.dtype.kind == "f" and np.isinf(variable.values).any():
            raise StorageError(f"{where}: {name}: holds an infinity")


def write(
    path: str | Path,
    variables: Mapping[str, object],
    title: str,
    attributes: Mapping[str, object],
    parents: Iterable[str | Path] = (),
) -> None:
    """Write a NetCDF file atomically: temporary file, reopened and checked, synced, renamed.

    The bytes depend on the content alone: no time, host or process goes inside.

    Args:
        path: where to; the folder is created.
        variables: name -> array with the dimensions of the schema, or (dims, array) for weights.
        title: what the file holds.
        attributes: global attributes; anything but text and numbers is stored as JSON. ``units``
            must hold the units that the schema's words stand for.
        parents: files it was computed from, recorded with their SHA-256.

    Raises:
        StorageError: the content breaks the schema or the disk refuses it. No file is left behind.
    """
    path, parents = Path(path), list(parents)
    units = attributes["units"]
    data = {}
    for name, value in variables.items():
        if "." in name:
            dims, array = value
            data[name] = (dims, np.asarray(array), {"units": "1", "long_name": f"parameters {name}"})
        else:
            entry = VARIABLES.get(name)
            if entry is None:
                raise StorageError(f"{path}: variable '{name}' is not in the storage schema")
            word, power, exponent = entry.unit.partition("^")
            described = {"units": units.get(word, word) + power + exponent, "long_name": entry.long_name}
            data[name] = (entry.dims, np.asarray(value), described)
    dataset = xr.Dataset(data)
    dataset.attrs = {
        "Conventions": "CF-1.11",
        "title": title,
        "source": "hypernode",
        "schema_version": SCHEMA_VERSION,
        "history": f"written by the rule {attributes.get('rule', '(none)')}",
        "references": "arXiv: Fully data-driven inverse hyperelasticity with hyper-network neural ODE fields",
        # Relative to the file, so that a results folder can be moved and read from anywhere.
        "parents": json.dumps(ancestry(path, parents), sort_keys=True),
    }
    for key, value in attributes.items():
        simple = isinstance(value, (str, int, float)) and not isinstance(value, bool)
        dataset.attrs[key] = value if simple else json.dumps(value, sort_keys=True)
    check_schema(dataset, str(path))
    write_bytes_atomically(path, lambda temporary: _store(dataset, temporary), attributes, parents)


def _store(dataset: xr.Dataset, temporary: Path) -> None:
    packing = {
        name: {"zlib": True, "complevel": 1, "shuffle": True, "fletcher32": True, "_FillValue": None}
        for name, variable in dataset.variables.items()
        if variable.ndim
    }
    dataset.to_netcdf(temporary, engine="netcdf4", format="NETCDF4", encoding=packing)
    with xr.open_dataset(temporary, engine="netcdf4", decode_times=False) as again:
        for name in dataset.variables:
            if not np.array_equal(again[name].values, dataset[name].values, equal_nan=again[name].dtype.kind == "f"):
                raise StorageError(f"{temporary}: {name}: reads back differently from what was written")


def ancestry(path: Path, parents: Iterable[str | Path]) -> dict[str, str]:
    """Parents of a file, relative to it, with their SHA-256."""
    return {os.path.relpath(p, Path(path).parent): sha256(p) for p in parents}


def write_bytes_atomically(
    path: str | Path, store, provenance: Mapping[str, object], parents: Iterable[str | Path] = ()
) -> None:
    """Call ``store(temporary path)`` beside ``path``, sync it to disk and rename it into place.

    The record goes first: a crash in between leaves a record without its file, never the reverse.

    Args:
        path: where to; the folder is created.
        store: writes the content to the path it is given.
        provenance: what the job says of itself, for the record.
        parents: files it was computed from.

    Raises:
        StorageError: the disk refuses. No file is left behind.
    """
    path = Path(path)
    record = record_of(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with _temporary(path) as content, _temporary(record) as beside:
            store(content)
            beside.write_text(make_record(sha256(content), provenance, ancestry(path, parents)), encoding="utf-8")
            for temporary, final in ((beside, record), (content, path)):
                with open(temporary, "rb+") as handle:
                    os.fsync(handle.fileno())
                os.replace(temporary, final)
    except (OSError, RuntimeError) as error:
        if isinstance(error, StorageError):
            raise
        raise StorageError(
            f"{path}: cannot be written: {getattr(error, 'strerror', None) or error}; "
            "free space or permissions, then run again"
        ) from error


@contextlib.contextmanager
def _temporary(path: Path):
    # Two machines that share the folder may have processes of one number.
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp{path.suffix}")
    # What a job left that was killed, for its memory say; nobody else writes this file meanwhile.
    left = path.parent.glob(f".{glob.escape(path.name)}.*.tmp{glob.escape(path.suffix)}")
    try:
        for each in left:
            each.unlink(missing_ok=True)
        yield temporary
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def read(path: str | Path) -> xr.Dataset:
    """Read a data file into memory, after checking its parents where they still exist.

    Raises:
        StorageError: the file is missing, damaged, breaks the schema, or one of its parents has
            changed since.
    """
    path = Path(path)
    if not path.is_file():
        raise StorageError(f"{path}: no such file")
    check_digest(path)
    try:
        with xr.open_dataset(path, engine="netcdf4", decode_times=False) as opened:
            names = list(opened.variables)
            dataset = xr.Dataset(attrs=opened.attrs)
            for name in names:
                try:
                    dataset[name] = opened[name].load()
                except (OSError, RuntimeError, ValueError) as error:
                    raise StorageError(f"{path}: variable '{name}' is damaged: {error}") from error
    except StorageError:
        raise
    except (OSError, RuntimeError, ValueError, KeyError) as error:
        raise StorageError(f"{path}: damaged or not a NetCDF file: {error}") from error
    version = dataset.attrs.get("schema_version", 1)
    if version != SCHEMA_VERSION:
        raise StorageError(
            f"{path}: was written with version {version} of the file schema, and this program reads version "
            f"{SCHEMA_VERSION}: delete the results and run again, or use the program that wrote them"
        )
    check_schema(dataset, str(path))
    for parent, digest in json.loads(dataset.attrs.get("parents", "{}")).items():
        location = path.parent / parent
        if location.is_file() and sha256(location) != digest:
            raise StorageError(f"{path}: its parent {parent} is not the file it was computed from (changed or damaged)")
    return dataset


def units_of(dataset: xr.Dataset) -> dict[str, str]:
    """The units that the words ``length``, ``stress``, ``force`` and ``energy`` stand for in a file."""
    return json.loads(dataset.attrs["units"])


__all__ = ["EXPERIMENT_UNITS", "SYNTHETIC_UNITS", "StorageError", "read", "sha256", "sheet_units", "units_of", "write"]
