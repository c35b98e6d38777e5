"""What noise does to the data of an identification (paper: noise_example, panels a to c)."""

import matplotlib.pyplot as plt
import numpy as np

from hypernode.data.measurement import field_gradient, measured_displacement
from hypernode.errors import ExpectedError
from hypernode.evaluation.noise import signal_to_noise
from hypernode.figures.style import (
    ERROR_MAP,
    FIELD_MAP,
    STRAIN_MAP,
    colour_bar,
    draw_field,
    interpolated,
    shared_norm,
    unit_label,
)
from hypernode.figures.trust import name_row, overall
from hypernode.storage.netcdf import units_of
from hypernode.tables.columns import significant

#: Share of cells within the ends of the scale of errors: those at interfaces would leave it to themselves.
USUAL = 99.0


class DeformationError(ExpectedError, ValueError):
    """The figure cannot be drawn; the message says which run is to blame."""


def draw(data, settings: dict):
    """One row a run: measured displacement, strain of the F that the method uses, and what that F misses.

    Args:
        data: ``measurement0``, ``field0``, ``evaluation0``, ...: opened files of each run.
        settings: ``runs`` (with ``label``), and ``step``, the load step drawn.

    Raises:
        DeformationError: the deformation of a run is not known.
    """
    runs, step = settings["runs"], settings["step"]
    rows = [_row(data, index, run, step) for index, run in enumerate(runs)]
    length = units_of(data["evaluation0"])["length"]
    name = "$F_\\mathrm{int}$" if all(interpolated(data[f"field{k}"]) for k in range(len(runs))) else "$F$"
    columns = (
        ("(a) measured displacement", FIELD_MAP, "$|u|$" + unit_label(length)),
        (f"(b) strain of the used {name}", STRAIN_MAP, "max. principal strain [-]"),
        (f"(c) error of the used {name}", ERROR_MAP, f"|{name} - $F_\\mathrm{{true}}$| [-]"),
    )
    size = (5.4, 1.55 * len(rows) + 0.9)
    figure, panels = plt.subplots(len(rows), 3, figsize=size, layout="constrained", squeeze=False)
    for column, (title, colours, label) in enumerate(columns):
        shown = np.concatenate([fields[column] for fields, _ in rows])
        norm = shared_norm([shown.min(), np.percentile(shown, USUAL)]) if column == 2 else shared_norm(shown)
        for row, (fields, error) in enumerate(rows):
            axes, evaluation = panels[row, column], data[f"evaluation{row}"]
            mappable = draw_field(axes, evaluation, fields[column], norm, colours)
            axes.set_xticks([])
            axes.set_yticks([])
            if row == 0:
                axes.set_title(title, loc="left")
            if column == 0:
                name_row(axes, runs[row]["label"], overall(evaluation))
            if column == 2:
                axes.set_xlabel(error, fontsize=6.5)
        place = {"orientation": "horizontal", "fraction": 0.05, "pad": 0.02}
        colour_bar(figure, panels[:, column], mappable, label, shown, **place)
    return figure


def _row(data, index: int, run: dict, step: int):
    """((displacement, strain, error of F), each by cell; the error in words) of a run."""
    measurement, field, evaluation = (data[f"{key}{index}"] for key in ("measurement", "field", "evaluation"))
    if "F_truth" not in measurement:
        raise DeformationError(
            f"figures: the deformation of {run['case']} is not known, so that no error of it can be shown; leave the "
            "run out of this figure, which is of synthetic cases"
        )
    u = measured_displacement(measurement)[step]
    size = np.linalg.norm(u, axis=1)[evaluation["cells"].values].mean(axis=1)
    F, true = np.moveaxis(field_gradient(field), (0, 1), (2, 3)), measurement["F_truth"].values
    error = np.linalg.norm((F - true)[step], axis=(1, 2))
    ratio = signal_to_noise(F, true)[step]
    words = f"error {significant(float(np.sqrt(np.mean(error**2))))}, SNR {ratio:.1f} dB"
    return (size, evaluation["principal_strain_identified"].values[step], error), words
