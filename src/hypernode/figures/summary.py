"""The table of every run, as CSV and Markdown."""

import csv
import io
import json
from pathlib import Path

from hypernode.storage.netcdf import read, write_bytes_atomically

#: Column -> (key of the evaluation summary, format).
COLUMNS = {
    "stress error": ("stress_error", ".4f"),
    "all modes": ("stress_error_all_modes", ".4f"),
    "off interface": ("stress_error_off_interface", ".4f"),
    "contrast error": ("contrast_error", ".3f"),
    "correlation": ("correlation", ".3f"),
    "Dice": ("dice", ".3f"),
    "Dice, registered": ("dice_registered", ".3f"),
    "IoU": ("iou", ".3f"),
    "boundary distance": ("boundary_distance", ".3g"),
    "NRMSE matrix": ("curve_nrmse_matrix", ".4f"),
    "NRMSE inclusion": ("curve_nrmse_inclusion", ".4f"),
    "R2 matrix": ("curve_r2_matrix", ".4f"),
    "R2 inclusion": ("curve_r2_inclusion", ".4f"),
    "edge force error": ("edge_force_error", ".4f"),
    "nodal residual": ("equilibrium_residual", ".4f"),
    "equilibrium gap": ("equilibrium_gap", ".4f"),
    "inclusion / matrix": ("inclusion_over_matrix", ".2f"),
    "interpolant misfit": ("interpolant_misfit", ".4f"),
}


def rows(evaluations: list[str]) -> list[dict[str, str]]:
    """One row a run: case, method and every number of its evaluation, empty where it has none."""
    table = []
    for path in sorted(evaluations):
        attributes = read(path).attrs
        summary, run = json.loads(attributes["summary"]), json.loads(attributes["run"])
        row = {"case": run["case"], "method": run["method"]}
        for column, (key, fmt) in COLUMNS.items():
            value = summary.get(key)
            row[column] = "" if value is None or value != value else format(value, fmt)
        table.append(row)
    return table


def write_tables(evaluations: list[str], csv_file: str, markdown_file: str) -> None:
    """Write the summary of all runs."""
    table = rows(evaluations)
    names = ["case", "method", *COLUMNS]
    buffer = io.StringIO()
    writer = csv.DictWriter(buffer, names, lineterminator="\n")
    writer.writeheader()
    writer.writerows(table)
    lines = ["| " + " | ".join(names) + " |", "|" + " --- |" * len(names)]
    lines += ["| " + " | ".join(row[name] for name in names) + " |" for row in table]
    for path, text in ((csv_file, buffer.getvalue()), (markdown_file, "\n".join(lines) + "\n")):
        write_bytes_atomically(path, lambda temporary, text=text: Path(temporary).write_text(text, encoding="utf-8"))
