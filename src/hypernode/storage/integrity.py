"""Whether a result, its record, its parents and its raw inputs are what they were."""

import json
from pathlib import Path

from hypernode.storage.errors import StorageError
from hypernode.storage.findings import Finding, refused
from hypernode.storage.netcdf import read
from hypernode.storage.records import NOT_RESULTS, is_record, record_of, sha256
from hypernode.storage.report import RULE as REPORT


def damages(path: Path, record: dict, directory: Path) -> list[Finding]:
    """What has changed of one result file since its record was written.

    Args:
        path: the result file.
        record: its record.
        directory: where the workflow ran; raw inputs with relative paths are looked for there.
    """
    again = "make the report again" if record["rule"] == REPORT else "run again"
    found = []
    if record["sha256"] != sha256(path):
        found.append("its SHA-256 is not the recorded one: damaged or changed; delete it and run again")
    for parent, digest in record["parents"].items():
        place = path.parent / parent
        if not place.is_file():
            found.append(f"its parent {parent} is gone; {again}")
        elif sha256(place) != digest:
            found.append(f"its parent {parent} is not the file it was computed from; {again}")
    for raw, digest in record["raw_inputs"].items():
        place = directory / raw
        if not place.is_file():
            found.append(f"the raw input {raw} cannot be found any more; put it back or correct its path and run again")
        elif sha256(place) != digest:
            found.append(f"the raw input {raw} has changed since; run again")
    if path.suffix == ".nc" and not found:
        return _contradictions(path, record)
    return [Finding(str(path), message) for message in found]


def _contradictions(path: Path, record: dict) -> list[Finding]:
    """Where a NetCDF file and its record name different parents."""
    try:
        inside = json.loads(read(path).attrs["parents"])
    except StorageError as error:
        return [refused(error)]
    except (KeyError, ValueError):
        return [Finding(str(path), "it does not name its parents; delete it and run again")]
    if inside != record["parents"]:
        return [Finding(str(record_of(path)), "names other parents than the file itself: the record was changed")]
    return []


def orphans(folder: Path) -> list[Finding]:
    """Records in a results folder whose file is gone."""
    return [
        Finding(str(record), "a record without its file; run again, or delete it")
        for record in sorted(folder.rglob("*.json"))
        if record.relative_to(folder).parts[0] not in NOT_RESULTS
        and is_record(record)
        and not record.with_suffix("").is_file()
    ]
