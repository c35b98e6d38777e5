"""Fibre direction and anisotropy found in a sheet (paper: anisotropy_example)."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import Normalize

from hypernode.data.measurement import field_gradient, measured_displacement, mesh_of
from hypernode.evaluation.probes import SMALLEST_ANISOTROPY, indicator, uniaxial_stress
from hypernode.fem.gradient import deformation_gradient
from hypernode.figures.style import (
    ANGLE_MAP,
    STRAIN_MAP,
    colour_bar,
    curve_places,
    draw_field,
    indicator_label,
    interpolated,
    is_biaxial,
    mark_places,
    shared_norm,
    unit_label,
)
from hypernode.material.files import material_of
from hypernode.mechanics.loads import tensile_axis
from hypernode.storage.netcdf import units_of

CURVE_POINTS = 9
#: Percentiles of a field between which colours differ: single cells that are far off would take the whole scale.
USUAL = (1.0, 99.0)


def draw(data, settings: dict):
    """Material and response, measured and interpolated F, stress, and the anisotropy and fibre angle that were found.

    The angle is drawn only where the identified response is anisotropic.

    Args:
        data: ``evaluation``, ``material``, ``truth``, ``measurement`` and ``field``: opened files.
        settings: ``step`` is the load step of deformation and stress.
    """
    evaluation, step = data["evaluation"], settings["step"]
    units = units_of(evaluation)
    figure, grid = plt.subplots(3, 3, figsize=(7.2, 6.6), layout="constrained")
    (truth, along, across), (measured, used, stress), (found, anisotropy, angle) = grid
    _materials(figure, (truth, found), data)
    _responses((along, across), evaluation, material_of(data["material"]), material_of(data["truth"]))
    _deformation(figure, (measured, used), data, step)
    _stress(figure, stress, evaluation, step)
    _fibres(figure, (anisotropy, angle), evaluation)
    for axes in grid.ravel():
        if axes in (along, across):
            axes.set_box_aspect(1)
            axes.set_xlabel("uniaxial stretch [-]")
            axes.set_ylabel("$P$" + unit_label(units["stress"]))
        else:
            axes.set_xlabel("$X$" + unit_label(units["length"]))
            axes.set_ylabel("$Y$" + unit_label(units["length"]))
    return figure


def _materials(figure, panels, data) -> None:
    """Panels a and f, on one scale: the true and the identified material at one stretch of all points."""
    evaluation = data["evaluation"]
    kind, stretch, found = evaluation.attrs["load"], evaluation.attrs["shape_stretch"], evaluation["trace_P"].values
    centres = evaluation["X"].values[evaluation["cells"].values].mean(axis=1)
    true = indicator(material_of(data["truth"]), centres, kind, stretch)
    norm = shared_norm(true, np.percentile(found, USUAL))
    label = indicator_label(kind, units_of(evaluation))
    titles = (f"(a) truth, all at {stretch:.3g}", f"(f) identified, all at {stretch:.3g}")
    for axes, field, title in zip(panels, (true, found), titles, strict=True):
        colour_bar(figure, axes, draw_field(axes, evaluation, field, norm), label)
        axes.set_title(title, loc="left")
        mark_places(axes, evaluation)


def _deformation(figure, panels, data, step: int) -> None:
    """Panels c and d, on one scale: F along the pull, measured and as the method uses it."""
    evaluation = data["evaluation"]
    i = tensile_axis(evaluation.attrs["load"]) or 0
    name = ("$F_{xX}$", "$F_{yY}$")[i]
    measured = deformation_gradient(mesh_of(evaluation), measured_displacement(data["measurement"]))[step, :, i, i]
    used = field_gradient(data["field"])[i, i, step]
    norm = shared_norm(np.nanpercentile(measured, USUAL), np.percentile(used, USUAL))
    kind = "interpolated" if interpolated(data["field"]) else "used"
    titles = (f"(c) measured {name} at {evaluation['stretch'].values[step]:.3g}", f"(d) {kind} {name}")
    for axes, field, title in zip(panels, (measured, used), titles, strict=True):
        shown = draw_field(axes, evaluation, np.ma.masked_invalid(field), norm, STRAIN_MAP)
        colour_bar(figure, axes, shown, name + " [-]", field[np.isfinite(field)])
        axes.set_title(title, loc="left")


def _stress(figure, axes, evaluation, step: int) -> None:
    """Panel e: the identified stress at the identified deformation."""
    kind = evaluation.attrs["load"]
    P, i = evaluation["P_field"].values[step], tensile_axis(kind)
    field = P[:, 0, 0] + P[:, 1, 1] if is_biaxial(kind) else P[:, i, i]
    shown = draw_field(axes, evaluation, field, shared_norm(np.percentile(field, USUAL)))
    colour_bar(figure, axes, shown, indicator_label(kind, units_of(evaluation)))
    axes.set_title(f"(e) stress at {evaluation['stretch'].values[step]:.3g}", loc="left")


def _fibres(figure, panels, evaluation) -> None:
    """Panels g and h: anisotropy of the identified response, and its stiffest direction where it has one."""
    first, second = panels
    anisotropy = evaluation["anisotropy"].values
    norm = shared_norm([0.0], anisotropy, evaluation["anisotropy_true"].values)
    colour_bar(figure, first, draw_field(first, evaluation, anisotropy, norm), "anisotropy [-]")
    first.set_title("(g) anisotropy found", loc="left")
    angle = np.ma.masked_where(anisotropy < SMALLEST_ANISOTROPY, evaluation["fibre_angle"].values)
    shown = draw_field(second, evaluation, angle, Normalize(-90.0, 90.0), ANGLE_MAP)
    colour_bar(figure, second, shown, "angle [degree]").set_ticks([-90, -45, 0, 45, 90])
    if np.ma.getmaskarray(angle).all():
        words = f"anisotropy below\n{SMALLEST_ANISOTROPY:g} everywhere"
        second.text(0.5, 0.8, words, ha="center", transform=second.transAxes)
    second.set_title("(h) stiffest direction from $X$", loc="left")


def _responses(panels, evaluation, found, true) -> None:
    """Panels b, on one scale: uniaxial stress along and across the true fibres at the marked points."""
    stretches = np.linspace(1.0, float(evaluation["stretch"].values.max()), CURVE_POINTS)
    for index, name, colour in curve_places(evaluation):
        point = evaluation["curve_location"].values[index]
        fibre = np.deg2rad(_true_angle(evaluation, point))
        for axes, turn in zip(panels, (fibre, fibre + np.pi / 2), strict=True):
            for material, style, kind in ((found, "-", "identified"), (true, "o", "truth")):
                values = _along(material, point, stretches, turn)
                axes.plot(stretches, values, style, color=colour, ms=3, mfc="none", label=f"{name}, {kind}")
    low, high = (function(axes.get_ylim()[end] for axes in panels) for function, end in ((min, 0), (max, 1)))
    for axes, title in zip(panels, ("(b) along the fibres", "(b) across the fibres"), strict=True):
        axes.set_ylim(low, 1.7 * high)
        axes.set_title(title, loc="left")
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
