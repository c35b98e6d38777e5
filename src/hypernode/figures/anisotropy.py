"""Fibre direction and anisotropy found in a sheet (paper: anisotropy_example)."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import Normalize

from hypernode.evaluation.probes import SMALLEST_ANISOTROPY, uniaxial_stress
from hypernode.figures.style import (
    ANGLE_MAP,
    FIELD_MAP,
    INCLUSION,
    MATRIX,
    RC,
    STRAIN_MAP,
    colour_bar,
    draw_field,
    save,
    shared_norm,
    unit_label,
)
from hypernode.material.files import load_material
from hypernode.storage.netcdf import read, units_of

CURVE_POINTS = 9


def draw(inputs: dict[str, str], files: dict[str, str], settings: dict, provenance: dict) -> None:
    """Strain, stress, anisotropy and fibre angle, and uniaxial stress along and across the fibres.

    The angle is drawn only where the identified response is anisotropic.

    Args:
        inputs: ``evaluation``, ``material`` and ``truth``: paths.
        files: format -> path.
        settings: ``step`` is the load step of the strain.
        provenance: what the job says of itself.
    """
    data = read(inputs["evaluation"])
    found, true = load_material(inputs["material"]), load_material(inputs["truth"])
    units = units_of(data)
    length, stress = unit_label(units["length"]), unit_label(units["stress"])
    anisotropy = data["anisotropy"].values
    with plt.rc_context(RC):
        figure, grid = plt.subplots(2, 3, figsize=(7.2, 4.4), layout="constrained")
        a, b, c, d, e, f = grid.ravel()
        strain = data["principal_strain"].values[settings["step"]]
        colour_bar(figure, a, draw_field(a, data, strain, shared_norm(strain), STRAIN_MAP), "max. principal strain [-]")
        trace = data["trace_P"].values
        colour_bar(figure, b, draw_field(b, data, trace, shared_norm(trace), FIELD_MAP), "tr $P$" + stress)
        norm = shared_norm([0.0], anisotropy, data["anisotropy_true"].values)
        colour_bar(figure, c, draw_field(c, data, anisotropy, norm, FIELD_MAP), "anisotropy [-]")
        angle = np.ma.masked_where(anisotropy < SMALLEST_ANISOTROPY, data["fibre_angle"].values)
        shown = draw_field(d, data, angle, Normalize(-90.0, 90.0), ANGLE_MAP)
        colour_bar(figure, d, shown, "stiffest direction from X [degree]")
        stretches = np.linspace(1.0, float(data["stretch"].values.max()), CURVE_POINTS)
        places = zip(data["curve_location"].values, (MATRIX, INCLUSION), ("matrix", "inclusion"), strict=True)
        for point, colour, name in places:
            d.plot(*point, "s", color=colour, mec="white", ms=5)
            fibre = np.deg2rad(_true_angle(data, point))
            for axes, turn in ((e, fibre), (f, fibre + np.pi / 2)):
                for material, style, kind in ((found, "-", "identified"), (true, "o", "truth")):
                    values = _along(material, point, stretches, turn)
                    axes.plot(stretches, values, style, color=colour, ms=3, mfc="none", label=f"{name}, {kind}")
        titles = (
            f"strain at {data['stretch'].values[settings['step']]:.3g}",
            f"identified, all at {data.attrs['shape_stretch']:.3g}",
            "anisotropy of the response",
            "stiffest direction",
            "along the fibres",
            "across the fibres",
        )
        for letter, axes, title in zip("abcdef", grid.ravel(), titles, strict=True):
            axes.set_title(f"({letter}) {title}", loc="left")
            if letter in "abcd":
                axes.set_xlabel("X" + length)
                axes.set_ylabel("Y" + length)
            else:
                axes.set_xlabel("uniaxial stretch [-]")
                axes.set_ylabel("$P$" + stress)
        e.set_ylim(top=1.6 * e.get_ylim()[1])
        e.legend(frameon=False, loc="upper left", fontsize=6)
        save(figure, files, provenance, inputs.values())


def _true_angle(data, point) -> float:
    centres = data["X"].values[data["cells"].values].mean(axis=1)
    cell = int(np.argmin(np.sum((centres - point) ** 2, axis=1)))
    return float(data["fibre_angle_true"].values[cell]) if data["anisotropy_true"].values[cell] > 1e-6 else 0.0


def _along(material, point, stretches, angle: float) -> np.ndarray:
    """Uniaxial stress (stretch,) of one point in a direction: the material turned by -angle, pulled along x."""

    class Turned:
        def stress(self, X, F):
            return R.T @ np.asarray(material.stress(X, R @ F @ R.T), float) @ R

        def tangent(self, X, F):
            A = np.asarray(material.tangent(X, R @ F @ R.T), float)
            return np.einsum("ia,jb,kc,ld,...ijkl->...abcd", R, R, R, R, A)

    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s], [s, c]])
    return uniaxial_stress(Turned(), np.asarray(point)[None], stretches, 0)[:, 0, 0]
