"""Stage 12: one HTML file in which a sheet is asked for its stress-stretch curve at any point."""

import json
from collections.abc import Mapping
from pathlib import Path

from hypernode.explorer.page import explorer_page
from hypernode.storage.netcdf import read, write_bytes_atomically
from hypernode.storage.run_files import run_files

#: Result file -> what the page calls it.
_NAMES = {
    "evaluation": "evaluation",
    "measurement": "measurement",
    "constrained": "constrained",
    "material": "material",
    "true_material": "truth",
}


def run(files: Mapping[str, str], beside: Mapping[str, str], output: str, attributes: dict) -> None:
    """Write the explorer of a run as a result, with a record.

    Args:
        files: paths of ``evaluation``, ``material``, ``measurement`` and, where there are any, ``constrained``,
            ``truth``, ``references`` and ``sheet_<phase>``.
        beside: those of a run that is shown beside it; empty without.
    """
    text = page(files, beside)
    parents = dict.fromkeys([*files.values(), *beside.values()])
    write_bytes_atomically(
        output, lambda temporary: Path(temporary).write_text(text, encoding="utf-8"), attributes, parents
    )


def page(files: Mapping[str, str], beside: Mapping[str, str]) -> str:
    """The text of the page; arguments as of :func:`run`."""
    opened = {path: read(path) for path in dict.fromkeys([*files.values(), *beside.values()])}
    first, second = ({key: opened[path] for key, path in each.items()} for each in (files, beside))
    return explorer_page(first, second or None)


def files_of(folder: Path) -> dict[str, str]:
    """Result files of a run by what they are, found from its evaluation.

    Args:
        folder: results/CASE/METHOD.

    Raises:
        StorageError: the folder has no evaluation, or a file that it needs is gone.
    """
    files = {_NAMES[name]: path for name, path in run_files(folder).items() if name in _NAMES}
    references = folder / "references.nc"
    if references.is_file():
        files["references"] = references
        for label in json.loads(read(references).attrs["load_cases"]):
            phase, case = label.split(": ")
            files[f"sheet_{phase}"] = folder.parent.parent / case / "measurement.nc"
    return {key: str(path) for key, path in files.items() if path.is_file()}
