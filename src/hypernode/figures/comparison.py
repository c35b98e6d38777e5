"""Material fields of several runs side by side (paper: the ablations, the breakdown, the noise study)."""

import matplotlib.pyplot as plt
import numpy as np

from hypernode.errors import ExpectedError
from hypernode.evaluation.probes import indicator
from hypernode.figures.style import ERROR_MAP, FIELD_MAP, colour_bar, draw_field, indicator_label, shared_norm
from hypernode.figures.trust import name_row, overall
from hypernode.material.files import material_of
from hypernode.storage.netcdf import units_of
from hypernode.tables.columns import significant
from hypernode.verdict import Level


class ComparisonError(ExpectedError, ValueError):
    """A comparison cannot be drawn; the message says which run is to blame."""


def _rows(data, settings):
    """(label, opened file, fields by stretch, true fields or None, level of its verdict) of each row."""
    stretches, kind, errors = settings["stretches"], settings["load"], settings["show"] == "error"
    rows = []
    for index, run in enumerate(settings["runs"]):
        file, truth = data[f"run{index}"], data.get(f"truth{index}")
        if errors and truth is None:
            raise ComparisonError(
                f"figures: the run {run['case']}/{run['method']} has no known truth to show an error against; leave it "
                "out or write 'show: stress'"
            )
        X = file["X"].values[file["cells"].values].mean(axis=1)
        true = None if truth is None else [indicator(material_of(truth), X, kind, s) for s in stretches]
        if true and index == 0 and not errors:
            rows.append(("truth", file, true, None, Level.PASSED))
        found = [indicator(material_of(file), X, kind, s) for s in stretches]
        rows.append((run["label"], file, found, true, overall(data[f"evaluation{index}"])))
    return rows


def draw(data, settings: dict):
    """One row a run and one column a stretch: the stress when every point undergoes that stretch.

    Rows of runs that do not pass say so, in the colour of their verdict.

    Args:
        data: ``run0``, ``run1``, ...: opened material files; ``evaluation0``, ...; ``truth0``, ...: true materials
            where known.
        settings: ``runs`` (with ``label``), ``stretches``, ``load``, and ``show``: ``stress``, or
            ``error`` for the difference from the truth over its mean.

    Raises:
        ComparisonError: an error is to be shown of a run without a truth.
    """
    stretches, errors = settings["stretches"], settings["show"] == "error"
    rows = _rows(data, settings)
    units = units_of(rows[0][1])
    label = "error / mean stress [%]" if errors else indicator_label(settings["load"], units)
    size = (1.55 * len(stretches) + 0.7, 1.45 * len(rows) + 0.7)
    figure, panels = plt.subplots(len(rows), len(stretches), figsize=size, layout="constrained", squeeze=False)
    for column, stretch in enumerate(stretches):
        shown = [
            100.0 * np.abs(found[column] - true[column]) / np.abs(true[column]).mean() if errors else found[column]
            for _, _, found, true, _ in rows
        ]
        norm = shared_norm(np.percentile(np.concatenate(shown), [0.5, 99.5]))
        for row, (title, file, found, true, judged) in enumerate(rows):
            axes = panels[row, column]
            mappable = draw_field(axes, file, shown[row], norm, ERROR_MAP if errors else FIELD_MAP)
            axes.set_xticks([])
            axes.set_yticks([])
            if row == 0:
                axes.set_title(f"stretch {stretch:g}")
            if column == 0:
                name_row(axes, title, judged)
            if true is not None:
                error = np.linalg.norm(found[column] - true[column]) / np.linalg.norm(true[column])
                axes.set_xlabel(f"error {significant(100 * error)} %", fontsize=6.5)
        place = {"orientation": "horizontal", "fraction": 0.05, "pad": 0.02}
        colour_bar(figure, panels[:, column], mappable, label, np.concatenate(shown), **place)
    return figure
