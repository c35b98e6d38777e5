"""Fibre direction and anisotropy found in a sheet (paper: anisotropy_example)."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import Normalize

from hypernode.evaluation.probes import SMALLEST_ANISOTROPY, uniaxial_stress
from hypernode.figures.style import (
    ANGLE_MAP,
    STRAIN_MAP,
    colour_bar,
    curve_places,
    draw_field,
    indicator_label,
    mark_places,
    shared_norm,
    unit_label,
)
from hypernode.material.files import material_of
from hypernode.storage.netcdf import units_of

CURVE_POINTS = 9


def draw(data, settings: dict):
    """Strain, stress, anisotropy and fibre angle, and uniaxial stress along and across the fibres.

    The angle is drawn only where the identified response is anisotropic.

    Args:
        data: ``evaluation``, ``material`` and ``truth``: opened files.
        settings: ``step`` is the load step of the strain.
    """
    evaluation, step = data["evaluation"], settings["step"]
    units = units_of(evaluation)
    anisotropy = evaluation["anisotropy"].values
    figure, grid = plt.subplots(2, 3, figsize=(7.2, 4.5), layout="constrained")
    a, b, c, d, e, f = grid.ravel()
    strain, field = evaluation["principal_strain_measured"].values[step], evaluation["trace_P"].values
    shown = draw_field(a, evaluation, strain, shared_norm(strain), STRAIN_MAP)
    colour_bar(figure, a, shown, "max. principal strain [-]")
    shown = draw_field(b, evaluation, field, shared_norm(field))
    colour_bar(figure, b, shown, indicator_label(evaluation.attrs["load"], units))
    norm = shared_norm([0.0], anisotropy, evaluation["anisotropy_true"].values)
    colour_bar(figure, c, draw_field(c, evaluation, anisotropy, norm), "anisotropy [-]")
    angle = np.ma.masked_where(anisotropy < SMALLEST_ANISOTROPY, evaluation["fibre_angle"].values)
    bar = colour_bar(figure, d, draw_field(d, evaluation, angle, Normalize(-90.0, 90.0), ANGLE_MAP), "angle [degree]")
    bar.set_ticks([-90, -45, 0, 45, 90])
    if np.ma.getmaskarray(angle).all():
        d.text(0.5, 0.8, f"anisotropy below\n{SMALLEST_ANISOTROPY:g} everywhere", ha="center", transform=d.transAxes)
    mark_places(d, evaluation)
    _responses((e, f), evaluation, material_of(data["material"]), material_of(data["truth"]))
    titles = (
        f"measured strain at {evaluation['stretch'].values[step]:.3g}",
        f"identified, all at {evaluation.attrs['shape_stretch']:.3g}",
        "anisotropy of the response",
        "stiffest direction from $X$",
        "along the fibres",
        "across the fibres",
    )
    for letter, axes, title in zip("abcdef", grid.ravel(), titles, strict=True):
        axes.set_title(f"({letter}) {title}", loc="left")
        if letter in "abcd":
            axes.set_xlabel("$X$" + unit_label(units["length"]))
            axes.set_ylabel("$Y$" + unit_label(units["length"]))
        else:
            axes.set_box_aspect(1)
            axes.set_xlabel("uniaxial stretch [-]")
            axes.set_ylabel("$P$" + unit_label(units["stress"]))
    return figure


def _responses(panels, evaluation, found, true) -> None:
    """Panels e and f, on one scale: uniaxial stress along and across the true fibres at the marked points."""
    stretches = np.linspace(1.0, float(evaluation["stretch"].values.max()), CURVE_POINTS)
    for index, name, colour in curve_places(evaluation):
        point = evaluation["curve_location"].values[index]
        fibre = np.deg2rad(_true_angle(evaluation, point))
        for axes, turn in zip(panels, (fibre, fibre + np.pi / 2), strict=True):
            for material, style, kind in ((found, "-", "identified"), (true, "o", "truth")):
                values = _along(material, point, stretches, turn)
                axes.plot(stretches, values, style, color=colour, ms=3, mfc="none", label=f"{name}, {kind}")
    low, high = (function(axes.get_ylim()[end] for axes in panels) for function, end in ((min, 0), (max, 1)))
    for axes in panels:
        axes.set_ylim(low, 1.7 * high)
    panels[0].legend(loc="upper left")


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
