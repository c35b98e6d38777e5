"""Small evaluation files, written as the stages write them."""

import json

import numpy as np

from hypernode.storage.netcdf import write

UNITS = {"length": "1", "stress": "Pa", "force": "Pa", "energy": "Pa"}


def evaluation(folder, case, method, summary, variables=None, stage="evaluation", **units):
    """Write a result file of one run; returns its path."""
    path = folder / f"results/{case}/{method}/{stage}.nc"
    attributes = {"units": UNITS | units, "run": {"case": case, "method": method}, "summary": summary}
    write(path, variables or {"stretch": np.array([1.1])}, f"{stage} of {case}", attributes)
    return str(path)


def rows_of(markdown: str) -> list[list[str]]:
    """Cells of a Markdown table, its head first, without the line under it."""
    lines = [line for line in markdown.splitlines() if line.startswith("|")]
    cells = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines]
    return [cells[0], *cells[2:]]


def summary(error, **more):
    """Summary of a run whose errors are all alike."""
    numbers = {"stress_error": error, "stress_error_all_modes": error, "contrast_error": error, "dice": 1.0 - error}
    return json.loads(json.dumps(numbers | more))
