"""Tables of runs, of their times, and of what the configuration defines: CSV, Markdown and LaTeX."""

import csv
import io
import json
from fnmatch import fnmatch
from pathlib import Path

import numpy as np

from hypernode.storage.netcdf import read, write_bytes_atomically

#: Column -> (key of the evaluation summary, format).
COLUMNS = {
    "stress error": ("stress_error", ".4f"),
    "all modes": ("stress_error_all_modes", ".4f"),
    "off interface": ("stress_error_off_interface", ".4f"),
    "against cell means": ("stress_error_cell_mean", ".4f"),
    "contrast error": ("contrast_error", ".3f"),
    "misfit of u [noise]": ("displacement_misfit", ".2f"),
    "constrained field alone": ("stress_error_constrained", ".4f"),
    "networks against it": ("network_error", ".4f"),
    "spread": ("spread", ".4f"),
    "truth within two spreads": ("within_two_spreads", ".2f"),
    "correlation": ("correlation", ".3f"),
    "Dice": ("dice", ".3f"),
    "Dice, registered": ("dice_registered", ".3f"),
    "IoU": ("iou", ".3f"),
    "boundary distance": ("boundary_distance", ".3g"),
    "fibre angle error [degree]": ("fibre_angle_error", ".2f"),
    "NRMSE matrix": ("curve_nrmse_matrix", ".4f"),
    "NRMSE inclusion": ("curve_nrmse_inclusion", ".4f"),
    "R2 matrix": ("curve_r2_matrix", ".4f"),
    "R2 inclusion": ("curve_r2_inclusion", ".4f"),
    "edge force error": ("edge_force_error", ".4f"),
    "nodal residual": ("equilibrium_residual", ".4f"),
    "equilibrium gap": ("equilibrium_gap", ".4f"),
    "inclusion / matrix": ("inclusion_over_matrix", ".2f"),
    "interpolant misfit": ("interpolant_misfit", ".4f"),
    "SNR measured [dB]": ("snr_measured", ".1f"),
    "SNR smoothed [dB]": ("snr_smoothed", ".1f"),
    "SNR used [dB]": ("snr_used", ".1f"),
    "parameters": ("parameters", "d"),
    "unseen loads, u": ("unseen_displacement_error", ".4f"),
    "unseen loads, forces": ("unseen_force_error", ".4f"),
    "unseen loads without equilibrium": ("unseen_without_equilibrium", "d"),
    "sheet of the matrix, NRMSE": ("reference_nrmse_matrix", ".4f"),
    "sheet of the inclusion, NRMSE": ("reference_nrmse_inclusion", ".4f"),
    "frames not used, NRMSE": ("reference_nrmse_whole", ".4f"),
}


def _shown(value, fmt: str) -> str:
    return "" if value is None or value != value else format(value, fmt)


def run_rows(evaluations: list[str], columns: list[str], groups: dict[str, str]) -> list[dict[str, str]]:
    """One row a run, or one a group of runs with mean, spread and worst value.

    Args:
        evaluations: evaluation files.
        columns: names in :data:`COLUMNS`.
        groups: label -> pattern of ``case/method``; runs are listed one by one where it is empty.
    """
    runs = []
    for path in sorted(evaluations):
        attributes = read(path).attrs
        runs.append((json.loads(attributes["run"]), json.loads(attributes["summary"])))
    if not groups:
        return [
            {"case": run["case"], "method": run["method"]}
            | {name: _shown(summary.get(COLUMNS[name][0]), COLUMNS[name][1]) for name in columns}
            for run, summary in runs
        ]
    table = []
    for label, pattern in groups.items():
        members = [summary for run, summary in runs if fnmatch(f"{run['case']}/{run['method']}", pattern)]
        for statistic, function in (("mean", np.mean), ("spread", np.std), ("median", np.median), ("largest", np.max)):
            row = {"group": label, "runs": str(len(members)), "statistic": statistic}
            for name in columns:
                key, fmt = COLUMNS[name]
                values = [m[key] for m in members if m.get(key) is not None and m[key] == m[key]]
                row[name] = _shown(float(function(values)) if values else None, fmt.replace("d", ".0f"))
            table.append(row)
    return table


def ensemble_rows(evaluations: list[str], groups: dict[str, str]) -> list[dict[str, str]]:
    """One row a group of runs of one case that differ in their seeds: mean field, spread, calibration.

    Fields are P at common F, all modes and stretches. The spread is the standard deviation over the members; it is
    calibrated where the truth lies within two spreads of the mean in about 95 % of the places.
    """
    files = [(path, read(path)) for path in sorted(evaluations)]
    table = []
    for label, pattern in groups.items():
        members = [
            file for path, file in files if fnmatch("/".join(Path(path).parts[-3:-1]), pattern) and "P_true" in file
        ]
        if len(members) < 2:
            raise ValueError(f"the ensemble '{label}' has {len(members)} members with a known truth, and needs two")
        P, true = np.stack([file["P_identified"].values for file in members]), members[0]["P_true"].values
        mean, spread = P.mean(axis=0), P.std(axis=0, ddof=1)
        size = np.sqrt(np.mean(true**2))
        row = {
            "ensemble": label,
            "runs": len(members),
            "error, mean of members": np.mean([np.sqrt(np.mean((member - true) ** 2)) for member in P]) / size,
            "error of the mean": np.sqrt(np.mean((mean - true) ** 2)) / size,
            "spread": np.sqrt(np.mean(spread**2)) / size,
            "truth within two spreads": np.mean(np.abs(mean - true) <= 2.0 * spread),
        }
        table.append({name: f"{value:.4f}" if isinstance(value, float) else str(value) for name, value in row.items()})
    return table


def timing_rows(evaluations: list[str]) -> list[dict[str, str]]:
    """Seconds of wall time and peak memory of every job, from the workflow's benchmark records."""
    table = []
    for path in sorted(map(Path, evaluations)):
        case, method = path.parts[-3:-1]
        records = path.parents[2] / "benchmarks" / case
        for record in sorted([*records.glob("*.jsonl"), *(records / method).glob("*.jsonl")]):
            values = json.loads(record.read_text(encoding="utf-8").splitlines()[-1])
            row = {"case": case, "method": method, "stage": record.stem, "wall time [s]": f"{values['s']:.1f}"}
            memory = values.get("max_rss")
            table.append(row | {"memory [MB]": "" if memory in (None, "NA") else f"{float(memory):.0f}"})
    return table


def settings_rows(entries: dict[str, dict]) -> list[dict[str, str]]:
    """One row an entry of a section of the configuration, its settings in one column each."""
    flat = {name: _flatten(entry) for name, entry in entries.items()}
    keys = list(dict.fromkeys(key for entry in flat.values() for key in entry))
    return [{"name": name} | {key: entry.get(key, "") for key in keys} for name, entry in flat.items()]


def _flatten(entry, prefix: str = "") -> dict[str, str]:
    flat = {}
    for key, value in entry.items():
        if isinstance(value, dict):
            flat |= _flatten(value, f"{prefix}{key}.")
        elif value is not None:
            flat[prefix + key] = ", ".join(map(str, value)) if isinstance(value, list) else str(value)
    return flat


def _csv(names, table) -> str:
    buffer = io.StringIO()
    writer = csv.DictWriter(buffer, names, lineterminator="\n")
    writer.writeheader()
    writer.writerows(table)
    return buffer.getvalue()


def _markdown(names, table) -> str:
    lines = ["| " + " | ".join(names) + " |", "|" + " --- |" * len(names)]
    lines += ["| " + " | ".join(row[name] for name in names) + " |" for row in table]
    return "\n".join(lines) + "\n"


def _latex(names, table) -> str:
    def line(cells):
        return " & ".join(cell.replace("_", r"\_").replace("%", r"\%") for cell in cells) + r" \\"

    body = [line(names), r"\midrule", *(line([row[name] for name in names]) for row in table)]
    head = r"\begin{tabular}{" + "l" * len(names) + "}"
    return "\n".join([head, r"\toprule", *body, r"\bottomrule", r"\end{tabular}"]) + "\n"


def write_tables(evaluations: list[str], settings: dict, files: dict[str, str], provenance: dict) -> None:
    """Write one table.

    Args:
        evaluations: evaluation files of the runs in it.
        settings: ``kind`` (runs, validation, references, ensemble, timing or settings), with ``columns`` and
            ``groups``, or ``entries``.
        files: ``csv``, ``markdown`` and ``latex`` paths.
        provenance: what the job says of itself.
    """
    if settings["kind"] in ("runs", "validation", "references"):
        own = {
            kind: [name for name, (key, _) in COLUMNS.items() if key.startswith(prefix)]
            for kind, prefix in (("validation", "unseen_"), ("references", "reference_"))
        }
        later = [name for names in own.values() for name in names]
        default = own.get(settings["kind"], [name for name in COLUMNS if name not in later])
        table = run_rows(evaluations, settings["columns"] or default, settings["groups"])
    elif settings["kind"] == "ensemble":
        table = ensemble_rows(evaluations, settings["groups"])
    elif settings["kind"] == "timing":
        table = timing_rows(evaluations)
    else:
        table = settings_rows(settings["entries"])
    names = list(table[0]) if table else ["case", "method"]
    for kind, text in (("csv", _csv), ("markdown", _markdown), ("latex", _latex)):
        content = text(names, table)
        write_bytes_atomically(
            files[kind],
            lambda temporary, content=content: Path(temporary).write_text(content, encoding="utf-8"),
            provenance,
            evaluations,
        )
