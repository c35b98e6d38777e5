"""Uncertainty budget of the level of the stress, as in the GUM (JCGM 100:2008, 8.1).

Displacements determine ratios of stiffness. The level follows from the forces over the cross-section. Every input has a
standard uncertainty and a sensitivity. Their products are summed in quadrature.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.data.loading import Loading
from hypernode.data.measurement import (
    PAIRING_OPEN,
    RELAXATION_OPEN,
    force_gain_uncertainty,
    force_offset_uncertainty,
    force_uncertainty,
    is_cut_out,
    mesh_of,
    relative_thickness,
    stress_resultants,
)
from hypernode.data.seen_share import seen_shares, strips
from hypernode.evaluation.limits import limited, not_judged, percent
from hypernode.evaluation.thresholds import SETTINGS, Threshold
from hypernode.fem.mesh import Mesh
from hypernode.verdict import Criterion

#: The input that depends on the field: what the points do not see of the sections.
SHARE = "share of the width"
#: Inputs of the cross-section and of the lengths. Samples of a field know the errors of the load cell alone.
BESIDE_SAMPLES = ("thickness", "pixel size", SHARE, "preload", "camera motion")


@dataclass(frozen=True)
class Part:
    """The contribution of one input.

    Attributes:
        name: of the input.
        prior: its relative standard uncertainty; for the zero of the load cell, over the largest force.
        level: relative standard uncertainty of the level that it causes.
    """

    name: str
    prior: float
    level: float


@dataclass(frozen=True)
class LevelBudget:
    """All parts.

    Attributes:
        parts: in the order of the table.
        seen: smallest part of a loaded section that the points cover.
    """

    parts: tuple[Part, ...]
    seen: float

    @property
    def level(self) -> float:
        """Relative standard uncertainty of the level."""
        return float(np.sqrt(sum(part.level**2 for part in self.parts)))

    def of(self, name: str) -> Part:
        """The part of an input."""
        return next(part for part in self.parts if part.name == name)

    @property
    def largest(self) -> list[Part]:
        """The parts that make up most of it, the largest first."""
        return sorted((part for part in self.parts if part.level > 0.0), key=lambda part: -part.level)


def level_budget(measurement: xr.Dataset, P: Float[np.ndarray, "step cell 2 2"]) -> LevelBudget | None:
    """The budget of an identified field; None without a recorded force, where the level is a convention.

    Args:
        measurement: opened file.
        P: stress of the identified field.
    """
    if measurement.attrs["forces"] != "measured":
        return None
    mesh, loading, shares = mesh_of(measurement), Loading.of(measurement), seen_shares(measurement)
    force = np.nan_to_num(np.abs(stress_resultants(measurement))).max(axis=(1, 2))
    of_case = np.array([force[loading.load_case == case].max() for case in loading.load_case])
    weights = _weights(measurement, force)
    zero, gain = force_offset_uncertainty(measurement), force_gain_uncertainty(measurement)
    zero_level = float(weights @ np.divide(of_case, force, out=np.zeros_like(force), where=force > 0.0)) * zero
    thickness, pixel = (float(measurement.attrs.get(f"{key}_uncertainty", 0.0)) for key in ("thickness", "pixel_size"))
    share, seen = _share(measurement, mesh, loading, shares, P * relative_thickness(measurement)[:, None, None])
    # Of a part of the sheet the stated width rules. Where all is seen, the section is measured in pixels.
    pixel_level = pixel if seen >= 1.0 else 0.0
    relaxation, pairing = (_open(measurement, name) for name in (RELAXATION_OPEN, PAIRING_OPEN))
    # A lag is one error of all steps; what relaxation leaves open differs from step to step.
    open_of = {"relaxation": float(np.sqrt(weights @ relaxation**2)), "pairing": float(weights @ pairing)}
    # Lengths and sections are those of the first picture. Every strain has the error of the camera's distance.
    preload, camera = (float(measurement.attrs.get(key, 0.0)) for key in ("preload", "camera_distance_uncertainty"))
    strain = np.linalg.norm(measurement["H"].values, axis=(1, 2))
    camera_level = float(weights @ np.divide(camera, strain, out=np.zeros_like(strain), where=strain > 0.0))
    parts = [
        Part("zero", zero, zero_level),
        Part("gain", gain, gain),
        Part("thickness", thickness, thickness),
        Part("pixel size", pixel, pixel_level),
        Part(SHARE, share, share),
        Part("preload", preload, preload),
        Part("camera motion", camera, camera_level),
        *(Part(key, value, value) for key, value in open_of.items()),
    ]
    return LevelBudget(tuple(parts), seen)


def level_of(budget: LevelBudget | None, *names: str) -> float:
    """Relative standard uncertainty of the level from some inputs together; zero without a budget."""
    return 0.0 if budget is None else float(np.sqrt(sum(budget.of(name).level ** 2 for name in names)))


def level_beside_samples(budget: LevelBudget | None) -> float:
    """Relative standard uncertainty of the level from the inputs that posterior samples do not contain."""
    return level_of(budget, *BESIDE_SAMPLES)


def stored_beside_samples(rows: Sequence[Mapping]) -> float:
    """The same of a budget that was stored by :func:`table`; zero of none."""
    return float(np.sqrt(sum(row["level"] ** 2 for row in rows if row["input"] in BESIDE_SAMPLES)))


def _weights(measurement: xr.Dataset, force: Float[np.ndarray, " step"]) -> Float[np.ndarray, " step"]:
    """How much each step tells of the level: forces weigh by their relative uncertainty, as in the identification."""
    uncertainty = np.maximum(force_uncertainty(measurement), SETTINGS.force_uncertainty)
    weights = np.where(force > 0.0, uncertainty**-2.0, 0.0)
    return weights / max(weights.sum(), np.finfo(float).tiny)


def _open(measurement: xr.Dataset, name: str) -> Float[np.ndarray, " step"]:
    """What a record leaves open of the force of every step, over the force."""
    return measurement[name].values if name in measurement else np.zeros(measurement.sizes["load_step"])


def _share(measurement, mesh: Mesh, loading: Loading, shares, P) -> tuple[float, float]:
    """(relative uncertainty of the force by what is not seen of the sections, smallest share that is seen)."""
    found, seen = [0.0], [1.0]
    if not is_cut_out(measurement):
        return 0.0, 1.0
    for case in range(len(shares)):
        steps = np.flatnonzero(loading.load_case == case)
        for axis in range(2):
            along = shares[case, 1 - axis]
            if along < 1.0 and loading.measured[steps, axis, axis].any():
                found.append(share_uncertainty(mesh, P[steps[-1], :, axis, axis], axis, along))
                seen.append(float(along))
    return max(found), min(seen)


def share_uncertainty(mesh: Mesh, normal: Float[np.ndarray, " cell"], axis: int, share: float) -> float:
    """Relative uncertainty of the force of a section that is measured in part.

    The strip beside the measured points is assumed to be like their rim. Two checks give the error of this assumption.
    Every section carries the same force, so the scatter over sections is an error. A band within the sheet, as wide as
    the strip, differs from the band beside it. The errors of both sides are independent.

    Args:
        normal: normal traction on the sections, times the relative thickness.
        axis: of that normal.
        share: measured part of a section.
    """
    grid, sizes = _on_sections(mesh, normal, axis)
    whole = np.nansum(grid * sizes, axis=1)
    strip, band = strips(float(sizes.sum()), share)
    ends = np.cumsum(sizes) - 0.5 * sizes
    from_both = ends, sizes.sum() - ends
    rims = [np.nanmean(grid[:, near < band], axis=1) for near in from_both]
    beside = [np.nanmean(grid[:, (near >= band) & (near < 2.0 * band + 1e-9)], axis=1) for near in from_both]
    force = whole + strip * (rims[0] + rims[1])
    mean = np.nanmean(force)
    missed = np.array([rim - next_to for rim, next_to in zip(rims, beside, strict=True)]) / (mean / sizes.sum() * share)
    scatter = float(np.nanstd(force) / mean)
    return float(np.hypot(scatter, (1.0 - share) * np.sqrt(0.5 * np.nanmean(missed**2))))


def _on_sections(mesh: Mesh, values: Float[np.ndarray, " cell"], axis: int):
    """(values by section and place along it, NaN in a hole; widths of those places)."""
    lines = mesh.lines
    sizes = np.diff(lines[1 - axis])
    centres = mesh.centres
    place = [np.searchsorted(lines[k], centres[:, k]) - 1 for k in (axis, 1 - axis)]
    grid = np.full((len(lines[axis]) - 1, len(sizes)), np.nan)
    grid[place[0], place[1]] = values
    return grid, sizes


def table(budget: LevelBudget) -> list[dict]:
    """The budget as rows for a file: input, prior, part of the level. The last row is the total."""
    rows = [{"input": part.name, "prior": part.prior, "level": part.level} for part in budget.parts]
    return [*rows, {"input": "level", "prior": None, "level": budget.level}]


def judge_level(budget: LevelBudget | None, threshold: Threshold) -> Criterion:
    """The criterion of a verdict, with every part and the cost of measuring a part of the width."""
    name = "level"
    if budget is None:
        return not_judged(name, "No force was recorded, so the level is a convention.")
    judged = limited(name, "The level of the stress is known to", budget.level, threshold)
    parts = ", ".join(f"{part.name} {percent(part.level)}" for part in budget.largest)
    sentence = f"{judged.sentence} Contributions: {parts or 'none is stated'}."
    if budget.seen < 1.0:
        sentence += (
            f" The points cover {percent(budget.seen)} of the width, and the strip beside them adds "
            f"{percent(budget.of(SHARE).level)}."
        )
    return replace(judged, sentence=sentence)
