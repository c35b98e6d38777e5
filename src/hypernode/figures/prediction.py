"""A prediction beside its test: force against stretch with its band, and strain, predicted, measured, difference."""

import json
from collections.abc import Iterable
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from matplotlib.colors import Normalize

from hypernode.data.lost import filled
from hypernode.data.measurement import measured_displacement, mesh_of
from hypernode.fem.gradient import deformation_gradient
from hypernode.fem.mesh import EDGE_NAMES, EDGES
from hypernode.figures.style import (
    FIELD_MAP,
    INCLUSION,
    MATRIX,
    RC,
    STRAIN_MAP,
    colour_bar,
    draw_field,
    force_label,
    from_zero,
    save,
    shared_norm,
)
from hypernode.storage.netcdf import units_of
from hypernode.tables.columns import significant

#: Percentiles of a strain between which its colours differ: single points may be far off.
USUAL = (1.0, 99.0)
#: Standard deviations on each side of a band.
BAND = 2.0


def draw(file: xr.Dataset):
    """The figure of an opened prediction."""
    with plt.rc_context(RC):
        tested = "u_measured" in file
        figure, axes = plt.subplots(1, 5 if tested else 3, figsize=(9.6 if tested else 6.2, 2.2), layout="constrained")
        labels = file["material_label"].values
        draw_field(axes[0], file, labels, Normalize(0, max(labels.max(), 1)), FIELD_MAP)
        axes[0].set_title("(a) phases", loc="left")
        axes[0].set_xticks([])
        axes[0].set_yticks([])
        edge, i, axis = _pulled(file)
        _forces(axes[1], file, edge, i)
        fields = {"predicted": _strain(file, file["u"].values[-1:], i, axis)}
        if tested:
            mesh, measured = mesh_of(file), measured_displacement(file)[-1:]
            fields["measured"] = _strain(file, filled(mesh, measured), i, axis)
            fields["difference"] = fields["predicted"] - fields["measured"]
        _maps(figure, axes[2:], file, fields, f"$E_{{{'xy'[i]}{'xy'[axis]}}}$ [-]")
    return figure


def write(file: xr.Dataset, source: Path, files: Iterable[Path]) -> None:
    """Draw an opened prediction into files, in the format that the ending of each names."""
    for each in files:
        provenance = {"rule": "hypernode predict"}
        save(draw(file), {each.suffix.lower().lstrip("."): str(each)}, provenance, [source])


def _pulled(file: xr.Dataset) -> tuple[int, int, int]:
    """(edge, component, axis of its normal) of the largest resultant on a right or an upper edge."""
    force = np.nan_to_num(np.abs(file["edge_force_predicted"].values[-1]))
    force[[EDGE_NAMES.index(name) for name in ("left", "bottom")]] = 0.0
    edge, i = np.unravel_index(force.argmax(), force.shape)
    return int(edge), int(i), EDGES[EDGE_NAMES[edge]][0]


def _forces(axes, file: xr.Dataset, edge: int, i: int) -> None:
    """Force against stretch, with a band of two spreads and the measured points."""
    for case in np.unique(file["load_case"].values):
        steps = file["load_case"].values == case
        stretch = np.concatenate([[1.0], file["stretch"].values[steps]])
        force, spread = (
            np.concatenate([[0.0], file[name].values[steps, edge, i]])
            for name in ("edge_force_predicted", "edge_force_spread")
        )
        first = case == 0
        axes.fill_between(stretch, force - BAND * spread, force + BAND * spread, color=MATRIX, alpha=0.25, lw=0)
        axes.plot(stretch, force, "-", color=MATRIX, label="predicted" if first else None)
        if "edge_force" in file and file.attrs["forces"] == "measured":
            measured = file["edge_force"].values[steps, edge, i]
            axes.plot(
                stretch[1:], measured, "o", color=INCLUSION, mfc="none", ms=4, label="measured" if first else None
            )
    errors = json.loads(file.attrs["score"])["force_error"]
    said = f"\nforces up to {significant(100 * max(errors))} % off" if errors else ""
    axes.set_title("(b) force", loc="left")
    axes.set_xlabel("mean stretch [-]" + said)
    axes.set_ylabel("edge force" + force_label(units_of(file)))
    from_zero(axes)
    axes.legend()


def _strain(file: xr.Dataset, u, i: int, axis: int):
    """Green-Lagrange strain of the cells, component (i, axis)."""
    F = deformation_gradient(mesh_of(file), u)[0]
    E = 0.5 * (np.einsum("cki,ckj->cij", F, F) - np.eye(2))
    return E[:, i, axis]


def _maps(figure, axes, file: xr.Dataset, fields: dict, label: str) -> None:
    """One map a field; those of one quantity in the same colours."""
    errors = json.loads(file.attrs["score"])["displacement_error"]
    usual = [np.percentile(values, USUAL) for name, values in fields.items() if name != "difference"]
    for letter, panel, (name, values) in zip("cde"[: len(fields)], axes, fields.items(), strict=True):
        bound = np.percentile(np.abs(values), USUAL[1])
        difference = name == "difference"
        norm = Normalize(-bound, bound) if difference else shared_norm(*usual)
        mappable = draw_field(panel, file, values, norm, "coolwarm" if difference else STRAIN_MAP)
        panel.set_title(f"({letter}) {name}", loc="left")
        panel.set_xticks([])
        panel.set_yticks([])
        if difference and errors:
            panel.set_xlabel(f"displacements up to\n{significant(100 * max(errors))} % off")
        if name != "predicted" or len(fields) == 1:
            colour_bar(figure, panel, mappable, label, values)
