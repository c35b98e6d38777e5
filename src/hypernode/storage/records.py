"""The record beside every result file: its digest, what it came from, and when and where it was made.

A result file itself holds nothing that differs between two equal runs; times, hosts and processors are here.
``material.nc`` has the record ``material.nc.json``.
"""

import getpass
import hashlib
import json
import os
import platform
import subprocess
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from functools import cache
from pathlib import Path

from hypernode.installation import repository
from hypernode.storage.environment import processor
from hypernode.storage.errors import StorageError

#: Keys that every record has.
REQUIRED = ("sha256", "parents", "raw_inputs", "rule", "settings", "code", "versions")
#: What describes a results folder as a whole; every other JSON file in one is a record.
CRATE = "ro-crate-metadata.json"
#: What Snakemake leaves in a folder that is the output of a rule.
_TIMESTAMP = ".snakemake_timestamp"
#: Folders of a run that hold no results: what a job said and how long it took.
NOT_RESULTS = ("logs", "benchmarks")


def sha256(path: str | Path) -> str:
    """Hexadecimal SHA-256 of a file's bytes."""
    with open(path, "rb") as handle:
        return hashlib.file_digest(handle, "sha256").hexdigest()


def is_record(path: Path) -> bool:
    """Whether a path is the record of a file, which may be gone: a run removes what it is about to write anew."""
    return path.suffix == ".json" and path.name != CRATE


def result_files(folder: Path) -> list[Path]:
    """Every result file of a run, without records, logs and benchmarks, in a fixed order."""
    return sorted(
        path
        for path in folder.rglob("*")
        if path.is_file()
        and path.relative_to(folder).parts[0] not in NOT_RESULTS
        and not is_record(path)
        and path.name != _TIMESTAMP
    )


def record_of(path: str | Path) -> Path:
    """Where the record of a result file is."""
    path = Path(path)
    return path.with_name(path.name + ".json")


@cache
def source_state() -> dict[str, str]:
    """Commit of the project and digest of its uncommitted changes; empty outside a repository."""
    root = repository()
    if root is None:
        return {}

    def git(*arguments):
        command = ["git", "-C", str(root), *arguments]
        return subprocess.run(command, capture_output=True, check=True, timeout=20).stdout  # noqa: S603 - fixed words

    try:
        commit, changes = git("rev-parse", "HEAD"), git("diff", "HEAD")
    except (OSError, subprocess.SubprocessError):
        return {}
    return {
        "commit": commit.decode().strip(),
        "uncommitted": hashlib.sha256(changes).hexdigest() if changes else "",
    }


def make_record(digest: str, provenance: Mapping[str, object], parents: Mapping[str, str]) -> str:
    """The text of a record.

    Args:
        digest: SHA-256 of the result file.
        provenance: rule, run, settings, code, versions, compiler, and raw_inputs where there are any.
        parents: path relative to the result file -> SHA-256.
    """
    settings = provenance.get("settings", "{}")
    content = {
        "sha256": digest,
        "parents": dict(parents),
        "raw_inputs": provenance.get("raw_inputs", {}),
        "rule": provenance.get("rule", ""),
        "run": provenance.get("run", {}),
        "settings": json.loads(settings) if isinstance(settings, str) else settings,
        "code": provenance.get("code", ""),
        "versions": provenance.get("versions", {}),
        "compiler": provenance.get("compiler", {}),
        "source": source_state(),
        "written": datetime.now(UTC).isoformat(timespec="seconds"),
        "host": platform.node(),
        "user": getpass.getuser() if "LOGNAME" in os.environ or "USER" in os.environ else str(os.getuid()),
        "python": platform.python_version(),
        "processor": processor(),
    }
    return _text(content | {"record": _own_digest(content)})


def _text(content) -> str:
    return json.dumps(content, indent=1, sort_keys=True) + "\n"


def _own_digest(content: Mapping[str, object]) -> str:
    return hashlib.sha256(_text({k: v for k, v in content.items() if k != "record"}).encode()).hexdigest()


def read_record(path: str | Path) -> dict:
    """The record of a result file.

    Raises:
        StorageError: there is none, or it is damaged.
    """
    place = record_of(path)
    try:
        text = place.read_text(encoding="utf-8")
        record = json.loads(text)
    except FileNotFoundError:
        raise StorageError(f"{path}: its record {place.name} is missing") from None
    except (OSError, ValueError) as error:
        raise StorageError(f"{place}: the record is damaged: {error}") from None
    if not isinstance(record, dict) or any(key not in record for key in REQUIRED):
        raise StorageError(f"{place}: the record is damaged: it lacks keys")
    if record.get("record") != _own_digest(record) or text != _text(record):
        raise StorageError(f"{place}: the record is damaged: it does not match its own digest")
    return record


def ancestry_of(targets: Iterable[Path]) -> dict[Path, dict]:
    """Files and all of their ancestors with their records, each file once, in a fixed order.

    Raises:
        StorageError: one of them has no intact record.
    """
    found, todo = {}, [Path(target).resolve() for target in targets]
    while todo:
        path = todo.pop()
        if path not in found:
            found[path] = read_record(path)
            todo += [(path.parent / parent).resolve() for parent in found[path]["parents"]]
    return dict(sorted(found.items()))


def check_digest(path: str | Path) -> None:
    """Check a result file against its record, where it has one.

    A file that was copied away from its record can still be read.

    Raises:
        StorageError: the file is not what was written.
    """
    if record_of(path).is_file() and read_record(path)["sha256"] != sha256(path):
        raise StorageError(
            f"{path}: is not what was written (its SHA-256 differs from its record): damaged; delete it and run again"
        )
