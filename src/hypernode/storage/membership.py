"""Which files of a results folder belong to the last run, by the crate that its last rule wrote."""

import json
from collections.abc import Mapping
from pathlib import Path

from hypernode.storage.findings import Finding
from hypernode.storage.records import CRATE, record_of
from hypernode.storage.report import RULE as REPORT


def described(folder: Path) -> dict[str, str] | None:
    """Files that the crate of a folder describes, relative to it, with their SHA-256; None without readable crate."""
    try:
        entities = json.loads((folder / CRATE).read_text(encoding="utf-8"))["@graph"]
        return {each["@id"]: each["sha256"] for each in entities if "File" in each["@type"] and "sha256" in each}
    except (OSError, ValueError, KeyError, TypeError):
        return None


def strangers(folder: Path, records: Mapping[Path, dict]) -> list[Finding]:
    """Files that the last run did not make, and files of the last run that are gone or made anew since.

    A report is made after the run, from its results, and is no stranger.

    Args:
        folder: the results folder.
        records: its files and their records.
    """
    members = described(folder)
    if members is None:
        message = "no readable crate: files that do not belong to the last run are not told; run to the end"
        return [Finding(str(folder / CRATE), message, notice=True)]
    found = []
    for path, record in records.items():
        name = path.relative_to(folder).as_posix()
        if name == CRATE or record["rule"] == REPORT:
            continue
        if name not in members:
            message = f"not part of the last run; delete it with its record {record_of(path).name}, or put what it "
            found.append(Finding(str(path), message + "belongs to back into the configuration and run again"))
        elif record["sha256"] != members[name]:
            found.append(Finding(str(path), f"made anew since {CRATE} was written; run to the end"))
    found += [
        Finding(str(folder / name), f"part of the last run but gone with its record, by {CRATE}; run again")
        for name in sorted(members)
        if not (folder / name).is_file() and not record_of(folder / name).is_file()
    ]
    return found
