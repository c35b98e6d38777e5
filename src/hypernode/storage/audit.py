"""Whether the results of a run are intact, of one kind, and all of them of the last run."""

import os
from pathlib import Path

from hypernode.storage.consistency import Now, foreign_flags, foreign_machines, foreign_versions
from hypernode.storage.errors import StorageError
from hypernode.storage.findings import Finding, refused
from hypernode.storage.integrity import damages, orphans
from hypernode.storage.membership import strangers
from hypernode.storage.records import read_record, result_files


def verify(folder: Path, now: Now = lambda rule, recorded: None) -> list[Finding]:
    """Rehash every file of a run and of its ancestry, and compare how they were made (docs/decisions/0027).

    Args:
        folder: the results folder, in the directory where the workflow ran.
        now: the flags and precision that a job of a rule would set now.

    Returns:
        Problems and notices; nothing where all is well.

    Raises:
        StorageError: there is no such folder, or nothing in it.
    """
    files = result_files(folder) if folder.is_dir() else []
    if not files:
        raise StorageError(f"{folder}: no results there; give the results folder of a run")
    # The results may be a link to another disk, so links are not followed to where the workflow ran.
    directory = Path(os.path.abspath(folder)).parent
    records, found = {}, []
    for path in files:
        try:
            records[path] = read_record(path)
        except StorageError as error:
            found.append(refused(error))
        else:
            found += damages(path, records[path], directory)
    found += orphans(folder) + strangers(folder, records)
    return found + foreign_versions(records) + foreign_flags(records, now) + foreign_machines(records)
