"""The fields of a run that the page draws over the sheet."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float, Int

from hypernode.data.measurement import measured_displacement, mesh_of
from hypernode.evaluation.phases import phase_numbers
from hypernode.evaluation.probes import SMALLEST_ANISOTROPY, equibiaxial_stress, preferred_direction
from hypernode.figures.style import ANGLE_MAP, ERROR_MAP, FIELD_MAP, STRAIN_MAP
from hypernode.material.field import Material
from hypernode.storage.netcdf import units_of

#: What stands in the place of the name of a colour map for fields of numbered phases.
PHASES = "phases"


@dataclass(frozen=True, kw_only=True)
class Map:
    """One field, in every cell.

    Attributes:
        key: by which the page knows the same field of another run.
        title, unit: what it is.
        about: a sentence on what it means.
        colours: a colour map, or :data:`PHASES`.
        values: one row for the sheet as such, or one a load step; NaN where there is none.
        truth: the same of the true material, where it is known.
        least: colours go from zero to this at least; None of a field of which only differences matter.
    """

    key: str
    title: str
    unit: str
    about: str
    colours: str
    values: Float[np.ndarray, "row cell"]
    truth: Float[np.ndarray, "row cell"] | None = None
    least: float | None = None


def maps_of(files: Mapping[str, xr.Dataset], material: Material, true: Material | None) -> list[Map]:
    """Every field that the files of a run know.

    Args:
        files: ``evaluation``, ``measurement``, and ``constrained`` where the method has one.
        material: the identified material.
        true: the true one, where it is known.
    """
    evaluation = files["evaluation"]
    stiffness, anisotropy, angle = _of_material(evaluation, material, true)
    found = [
        stiffness,
        anisotropy,
        angle,
        *_strains(evaluation),
        *_misfit(files),
        *_refuted(evaluation),
        *_spread(evaluation),
    ]
    found += _phases(evaluation, stiffness)
    if stiffness.truth is not None:
        error = 100.0 * np.abs(stiffness.values / stiffness.truth - 1.0)
        about = "Distance of the identified stiffness from the true one, over the true one."
        found.append(
            Map(
                key="error",
                title="Error of the stiffness",
                unit="%",
                about=about,
                colours=ERROR_MAP,
                values=error,
                least=0.0,
            )
        )
    return found


def _of_material(evaluation, material: Material, true: Material | None) -> list[Map]:
    """Stiffness, anisotropy and stiffest direction under one equibiaxial stretch."""
    centres, stretch = mesh_of(evaluation).centres, float(evaluation.attrs["shape_stretch"])

    def fields(each: Material):
        P = equibiaxial_stress(each, centres, [stretch])
        anisotropy, angle = preferred_direction(each, centres, stretch)
        # The direction of a material that has none is rounding.
        directed = np.where(anisotropy > SMALLEST_ANISOTROPY, angle % 180.0, np.nan)
        return [np.trace(P, axis1=2, axis2=3), anisotropy[None], directed[None]]

    under = f"when every point is stretched {stretch:.3g} times in both directions"
    described = (
        ("stiffness", "Stiffness, tr P", units_of(evaluation)["stress"], f"Trace of the stress {under}.", FIELD_MAP),
        ("anisotropy", "Anisotropy", "1", f"Difference over sum of the principal stresses {under}.", FIELD_MAP),
        (
            *("angle", "Fibre angle from x", "°"),
            f"Stiffest direction {under}; blank where the anisotropy is below {SMALLEST_ANISOTROPY}.",
            ANGLE_MAP,
        ),
    )
    truth = [None] * 3 if true is None else fields(true)
    # Anisotropies below that of a material with a direction are all alike.
    least = (None, SMALLEST_ANISOTROPY, None)
    return [
        Map(key=key, title=title, unit=unit, about=about, colours=colours, values=values, truth=known, least=smallest)
        for (key, title, unit, about, colours), values, known, smallest in zip(
            described, fields(material), truth, least, strict=True
        )
    ]


def _strains(evaluation) -> list[Map]:
    about = "Largest principal Green-Lagrange strain of the {} deformation."
    return [
        Map(
            key=f"strain_{which}",
            title=f"Principal strain, {which}",
            unit="1",
            about=about.format(which),
            colours=STRAIN_MAP,
            values=evaluation[f"principal_strain_{which}"].values.astype(float),
        )
        for which in ("measured", "identified")
    ]


def _misfit(files) -> list[Map]:
    """Distance of the measured displacement from that of the equilibrium field; nothing without such a field."""
    if "constrained" not in files:
        return []
    measurement, field = files["measurement"], files["constrained"]
    mesh, noisy = mesh_of(measurement), "residual" in field
    missed = field["residual"].values if noisy else measured_displacement(measurement) - field["u"].values
    corners = missed[:, mesh.cells] ** 2
    known = np.isfinite(corners)
    total, count = np.where(known, corners, 0.0).sum(axis=(2, 3)), known.sum(axis=(2, 3))
    # Over its error, of one component; as a length, of both.
    mean = np.divide(total * (1.0 if noisy else 2.0), count, out=np.full(total.shape, np.nan), where=count > 0)
    unit = "1" if noisy else units_of(measurement)["length"]
    title = "Displacement misfit over its error" if noisy else "Displacement misfit"
    over = ", root mean square of a component over its expected error" if noisy else ""
    about = f"Measured less identified displacement{over}."
    return [Map(key="misfit", title=title, unit=unit, about=about, colours=ERROR_MAP, values=np.sqrt(mean), least=0.0)]


def _refuted(evaluation) -> list[Map]:
    if "refuted_by" not in evaluation:
        return []
    about = "Displacement that is missed and grows with the test, over its noise; zero where chance makes as much."
    values = evaluation["refuted_by"].values[None]
    return [
        Map(
            key="refuted",
            title="Where the law fails",
            unit="1",
            about=about,
            colours=ERROR_MAP,
            values=values,
            least=0.0,
        )
    ]


def _spread(evaluation) -> list[Map]:
    if "trace_P_spread" not in evaluation:
        return []
    spread = 100.0 * evaluation["trace_P_spread"].values / np.abs(evaluation["trace_P"].values)
    about = "Standard deviation of the stiffness, by posterior samples and where interfaces cut cells."
    return [
        Map(
            key="spread",
            title="Spread of the stiffness",
            unit="%",
            about=about,
            colours=ERROR_MAP,
            values=spread[None],
            least=0.0,
        )
    ]


def _phases(evaluation, stiffness: Map) -> list[Map]:
    """Distinguishable phases against the true or printed ones, all numbered from 1, the softest."""
    labels = phase_numbers(evaluation)
    known = next((evaluation[name].values for name in ("phase", "shape_true") if name in evaluation), None)
    judged = stiffness.values[0] if stiffness.truth is None else stiffness.truth[0]
    return [
        Map(
            key="phases",
            title="Phases found",
            unit="1",
            about="Parts of the sheet whose stiffness can be told apart, from 1, the softest.",
            colours=PHASES,
            values=1.0 + from_softest(labels, stiffness.values[0])[None],
            truth=None if known is None else 1.0 + from_softest(known, judged)[None],
        )
    ]


def from_softest(labels: Int[np.ndarray, " cell"], stiffness: Float[np.ndarray, " cell"]) -> Int[np.ndarray, " cell"]:
    """Numbers of phases from 0 in the order of their median stiffness."""
    names = np.unique(labels)
    order = np.argsort([np.median(stiffness[labels == name]) for name in names], kind="stable")
    number = np.empty(len(names), int)
    number[order] = np.arange(len(names))
    return number[np.searchsorted(names, labels)]
