"""Which files make up a run, asked of its folder."""

import json
from pathlib import Path

from hypernode.storage.errors import StorageError
from hypernode.storage.netcdf import read


def run_files(folder: Path) -> dict[str, Path]:
    """Result files of a run by what they are: its ``evaluation``, and what that was computed from.

    Of the latter ``material`` and ``measurement`` are always among them; with networks ``gradient`` or ``interpolant``;
    where there are such ``constrained`` and ``true_material``.

    Args:
        folder: results/CASE/METHOD.

    Raises:
        StorageError: the folder has no evaluation, or one of its files is gone.
    """
    evaluation = folder / "evaluation.nc"
    if not evaluation.is_file():
        raise StorageError(f"{folder}: holds no evaluation.nc; name results/CASE/METHOD of a finished run")
    parents = [folder / parent for parent in json.loads(read(evaluation).attrs["parents"])]
    found = {path.stem: path for path in parents if path.suffix == ".nc"}
    for path in found.values():
        if not path.is_file():
            raise StorageError(f"{path}: no such file, and {evaluation} was computed from it: run again")
    return found | {"evaluation": evaluation}
