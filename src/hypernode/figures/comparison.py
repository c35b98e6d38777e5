"""Material fields of several runs side by side (paper: the ablations, the breakdown, the noise study)."""

import matplotlib.pyplot as plt
import numpy as np

from hypernode.evaluation.probes import indicator
from hypernode.figures.style import ERROR_MAP, FIELD_MAP, RC, draw_field, save, shared_norm, unit_label
from hypernode.material.files import load_material, material_of
from hypernode.storage.netcdf import read, units_of


def draw(inputs: dict[str, str], files: dict[str, str], settings: dict, provenance: dict) -> None:
    """One row a run and one column a stretch: the stress when every point undergoes that stretch.

    Args:
        inputs: ``run0``, ``run1``, ...: material files; ``truth0``, ...: true materials where known.
        files: format -> path.
        settings: ``runs`` (with ``label``), ``stretches``, ``load``, and ``show``: ``stress``, or
            ``error`` for the relative difference from the truth.
        provenance: what the job says of itself.
    """
    stretches, kind, errors = settings["stretches"], settings["load"], settings["show"] == "error"
    rows = []
    for index, run in enumerate(settings["runs"]):
        file = read(inputs[f"run{index}"])
        X = file["X"].values[file["cells"].values].mean(axis=1)
        truth = load_material(inputs[f"truth{index}"]) if f"truth{index}" in inputs else None
        true = [indicator(truth, X, kind, s) for s in stretches] if truth else None
        if true and index == 0 and not errors:
            rows.append(("truth", file, true, true))
        material = material_of(file)
        found = [indicator(material, X, kind, s) for s in stretches]
        rows.append((run["label"], file, found, true))
    biaxial = kind in ("equibiaxial", "biaxial", "shear")
    name = "tr $P$" if biaxial else f"$P_{{{'xX' if kind.endswith('x') else 'yY'}}}$"
    label = "relative error [-]" if errors else name + unit_label(units_of(rows[0][1])["stress"])
    with plt.rc_context(RC):
        size = (1.55 * len(stretches) + 0.7, 1.45 * len(rows) + 0.5)
        figure, panels = plt.subplots(len(rows), len(stretches), figsize=size, layout="constrained", squeeze=False)
        for column, stretch in enumerate(stretches):
            shown = []
            for _, _, found, true in rows:
                values = found[column]
                if errors:
                    values = np.abs(values - true[column]) / np.abs(true[column]).mean()
                shown.append(values)
            norm = shared_norm(np.percentile(np.concatenate(shown), [0.5, 99.5]))
            for row, (title, file, found, true) in enumerate(rows):
                axes = panels[row, column]
                mappable = draw_field(axes, file, shown[row], norm, ERROR_MAP if errors else FIELD_MAP)
                axes.set_xticks([])
                axes.set_yticks([])
                if row == 0:
                    axes.set_title(f"stretch {stretch:g}")
                if column == 0:
                    axes.set_ylabel(title)
                if true is not None and title != "truth":
                    error = np.linalg.norm(found[column] - true[column]) / np.linalg.norm(true[column])
                    axes.set_xlabel(f"error {100 * error:.1f} %", fontsize=6)
            bar = figure.colorbar(mappable, ax=panels[:, column], orientation="horizontal", fraction=0.05, pad=0.02)
            bar.set_label(label)
            bar.outline.set_visible(False)
        save(figure, files, provenance, inputs.values())
