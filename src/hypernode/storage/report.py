"""The browsable report of a run among the results that it shows."""

import hashlib
import shutil
import zipfile
from pathlib import Path

from hypernode.storage.errors import StorageError
from hypernode.storage.netcdf import write_bytes_atomically
from hypernode.storage.provenance import code_hash, describe
from hypernode.storage.records import read_record, result_files

#: What stands for a rule in the record of a report.
RULE = "report"


def shown_results(report: Path, folder: Path) -> list[Path]:
    """Results of a folder that a report holds byte for byte.

    Raises:
        StorageError: the report is no zip archive, or a result has no intact record.
    """
    try:
        with zipfile.ZipFile(report) as archive:
            inside = {hashlib.sha256(archive.read(name)).hexdigest() for name in archive.namelist()}
    except (OSError, zipfile.BadZipFile) as error:
        raise StorageError(f"{report}: cannot be read as a report: {error}") from None
    reports = [path for path in result_files(folder) if path.suffix == ".zip"]
    results = [path for path in result_files(folder) if path not in reports]
    return [path for path in results if read_record(path)["sha256"] in inside]


def file_report(report: Path, folder: Path) -> Path:
    """Copy a report into a results folder with a record, whose parents are the results that it shows.

    Returns:
        Where it is now.

    Raises:
        StorageError: the report shows nothing of this folder, or cannot be stored.
    """
    parents = shown_results(report, folder)
    if not parents:
        raise StorageError(f"{report}: shows no result of {folder}; make the report again from these results")
    place = folder / report.name
    provenance = describe(RULE, {}, {}, code_hash(__file__))
    write_bytes_atomically(place, lambda temporary: shutil.copyfile(report, temporary), provenance, parents)
    return place
