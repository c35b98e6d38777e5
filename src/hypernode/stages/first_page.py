"""Stage 13: the page that results are entered by."""

from collections import Counter
from collections.abc import Mapping
from pathlib import Path

from hypernode.explorer.first_page import first_page
from hypernode.storage.netcdf import read, write_bytes_atomically
from hypernode.storage.records import read_record


def run(evaluations: list[str], settings: Mapping, output: str, attributes: dict) -> None:
    """Write the page.

    Args:
        evaluations: paths of the evaluation of every run.
        settings: as of :func:`~hypernode.explorer.first_page.first_page`.

    Raises:
        StorageError: an evaluation is missing or damaged, or has no record.
        VerdictError: one holds no verdict.
    """
    commits = Counter(read_record(path)["source"].get("commit", "") for path in evaluations)
    text = first_page((read(path) for path in evaluations), commits, settings)
    write_bytes_atomically(
        output, lambda temporary: Path(temporary).write_text(text, encoding="utf-8"), attributes, evaluations
    )
