"""Many sheets of one population as one NetCDF file, of which xarray reads what is asked for and no more."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
import xarray as xr

from hypernode.storage.netcdf import ancestry, check_schema, read, write_bytes_atomically
from hypernode.storage.records import sha256
from hypernode.storage.schema import SCHEMA_VERSION, VARIABLES

#: What all sheets of a population share, as they have one mesh.
SHARED = ("X", "cells", "corners", "stretch")
#: Bytes of a field that are stored together: what is read at once where one sheet is asked for, or one field of all.
CHUNK = 2**20


def write_collection(path: str, sheets: Iterable[str | Path], attributes: Mapping[str, object]) -> None:
    """Write the collection of some sheets, in the order of their names.

    Along the dimension ``sheet`` stand ``case`` and what its settings name: ``geometry``, ``inclusion``, ``matrix``,
    ``noise``, ``seed``. Its ``verdict``, the first word of that, ``level``, and the SHA-256 of its file, ``digest``,
    follow. Every number of its summary is ``score.NAME``, NaN where it has none. Its fields are ``basis.*``, with NaN
    where a sheet has no such parameter.

    Args:
        path: where to.
        sheets: files of :func:`hypernode.stages.population.run`.
        attributes: what the job says of itself.

    Raises:
        StorageError: a sheet is damaged, or the disk refuses.
    """
    files = sorted(map(Path, sheets), key=lambda file: file.name)
    opened = [read(file) for file in files]
    data = {key: opened[0][key].variable for key in SHARED if key in opened[0]}
    data |= _labels(files, opened) | _scores(opened)
    for key in sorted({key for each in opened for key in each.variables} - set(data)):
        data[key] = _stacked(key, opened)
    dataset = xr.Dataset(data).set_coords(["case"])
    dataset.attrs = {
        "Conventions": "CF-1.11",
        "title": f"population of {len(files)} sheets",
        "source": "hypernode",
        "schema_version": SCHEMA_VERSION,
        "units": opened[0].attrs["units"],
        "parents": json.dumps(ancestry(Path(path), files), sort_keys=True),
        **{k: v if isinstance(v, str) else json.dumps(v, sort_keys=True) for k, v in attributes.items()},
    }
    check_schema(dataset, path)
    write_bytes_atomically(path, lambda temporary: _store(dataset, temporary), attributes, files)


def _labels(files: list[Path], opened: list[xr.Dataset]) -> dict[str, tuple]:
    rows = []
    for file, each in zip(files, opened, strict=True):
        settings, run = (json.loads(each.attrs[key]) for key in ("settings", "run"))
        case = settings["cases"][run["case"]]
        verdict = json.loads(each.attrs["summary"])["verdict"]
        rows.append(
            {"case": run["case"], "method": run["method"], "digest": sha256(file)}
            | {key: case.get(key) or "" for key in ("geometry", "inclusion", "matrix", "noise")}
            | {"seed": settings["noise"].get(case.get("noise"), {}).get("seed", 0)}
            | {"verdict": verdict, "level": verdict.partition(":")[0]}
        )
    return {
        key: ("sheet", np.array([row[key] for row in rows]), {"long_name": VARIABLES[key].long_name}) for key in rows[0]
    }


def _scores(opened: list[xr.Dataset]) -> dict[str, tuple]:
    summaries = [json.loads(each.attrs["summary"]) for each in opened]
    numbers = {
        key
        for summary in summaries
        for key, value in summary.items()
        if isinstance(value, (int, float)) and not isinstance(value, bool)
    }
    return {
        f"score.{key}": (
            "sheet",
            np.array([np.nan if summary.get(key) is None else summary[key] for summary in summaries], float),
            {"long_name": f"{key.replace('_', ' ')}, as evaluations have it"},
        )
        for key in sorted(numbers)
    }


def _stacked(key: str, opened: list[xr.Dataset]) -> tuple:
    """One field of all sheets, padded to the largest, NaN (-1 of whole numbers) where a sheet has none."""
    found = [each[key].values if key in each else None for each in opened]
    first = next(each[key] for each in opened if key in each)
    shape = np.max([each.shape for each in found if each is not None], axis=0)
    whole = np.full((len(found), *shape), -1 if first.dtype.kind in "iu" else np.nan, first.dtype)
    for row, values in zip(whole, found, strict=True):
        if values is not None:
            row[tuple(map(slice, values.shape))] = values
    return ("sheet", *first.dims), whole, dict(first.attrs)


def _store(dataset: xr.Dataset, temporary: Path) -> None:
    packing = {}
    for name, variable in dataset.variables.items():
        if variable.dtype.kind in "iuf" and variable.ndim:
            row = variable.dtype.itemsize * int(np.prod(variable.shape[1:]))
            rows = max(1, min(variable.shape[0], CHUNK // max(row, 1)))
            packing[name] = {"zlib": True, "complevel": 1, "shuffle": True, "fletcher32": True, "_FillValue": None}
            packing[name]["chunksizes"] = (rows, *variable.shape[1:])
    dataset.to_netcdf(temporary, engine="netcdf4", format="NETCDF4", encoding=packing)
