"""Uncertainty budget of the level of the stress, as in the GUM (JCGM 100:2008, 8.1).

Displacements determine ratios of stiffness. The level follows from the forces over the cross-section. Every input has a
standard uncertainty and a sensitivity. Their products are summed in quadrature. Inputs of type B have a prior from the
configuration, those of type A are found from the test. The zero of a load cell is a prior that forces can tell.
"""

from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, replace

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
from hypernode.data.seen_share import has_free_sides, section, seen_shares
from hypernode.evaluation.conditioning import posterior_uncertainty
from hypernode.evaluation.limits import limited, not_judged, percent
from hypernode.evaluation.thresholds import SETTINGS, Threshold
from hypernode.fem.mesh import Mesh
from hypernode.verdict import Criterion

#: The input that depends on the field: what the points do not see of the sections.
SHARE = "share of the width"
#: Name of the sum.
TOTAL = "level"
#: Every input, in the order of the table.
INPUTS = (
    *("zero", "gain", "thickness", "pixel size", SHARE),
    *("preload", "camera motion", "relaxation", "pairing"),
)
#: Inputs of the cross-section and of the lengths. Samples of a field know the errors of the load cell alone.
BESIDE_SAMPLES = ("thickness", "pixel size", SHARE, "preload", "camera motion")

#: Posterior over prior below which the test is said to tell of an input: a fifth of the prior variance is gone.
TOLD = 0.9
#: Powers of the strain by which the force of any law may bend between load steps, beside the unknown level.
BENDS = (0, 1, 2)


@dataclass(frozen=True)
class Part:
    """The contribution of one input.

    Attributes:
        name: of the input.
        prior: its relative standard uncertainty before the test; for the zero of the load cell, over the largest
            force. None for what is found from the test alone.
        posterior: the same after the test.
        level: relative standard uncertainty of the level that it causes then.
        told_by: what of the test tells of it: ``forces`` of the load steps, force ``record``, or identified ``field``.
    """

    name: str
    prior: float | None
    posterior: float
    level: float
    _: KW_ONLY
    told_by: str = ""

    @property
    def type(self) -> str:
        """A where it is evaluated from the test alone, B where it has a prior (JCGM 100:2008, 3.3)."""
        return "A" if self.prior is None else "B"

    @classmethod
    def stated(cls, name: str, prior: float, level: float | None = None) -> "Part":
        """An input of which the test tells nothing."""
        return cls(name, prior, prior, prior if level is None else level)

    @classmethod
    def found(cls, name: str, posterior: float, told_by: str) -> "Part":
        """An input that is found from the test."""
        return cls(name, None, posterior, posterior, told_by=told_by if posterior > 0.0 else "")


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
    by_zero = np.divide(of_case, force, out=np.zeros_like(force), where=force > 0.0)
    known = _zero_after(measurement, loading, by_zero, weights, zero)
    thickness, pixel = (float(measurement.attrs.get(f"{key}_uncertainty", 0.0)) for key in ("thickness", "pixel_size"))
    share, seen = _unseen(measurement, mesh, loading, shares, P * relative_thickness(measurement)[:, None, None])
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
        Part("zero", zero, known, float(weights @ by_zero) * known, told_by="forces" if known < TOLD * zero else ""),
        Part.stated("gain", gain),
        Part.stated("thickness", thickness),
        Part.stated("pixel size", pixel, pixel_level),
        Part.found(SHARE, share, "field"),
        Part.found("preload", preload, "record"),
        Part.stated("camera motion", camera, camera_level),
        *(Part.found(key, value, "record") for key, value in open_of.items()),
    ]
    return LevelBudget(tuple(parts), seen)


def _unseen(measurement: xr.Dataset, mesh: Mesh, loading: Loading, shares, P) -> tuple[float, float]:
    """(relative uncertainty of the force by what is not seen of the sections, smallest share that is seen)."""
    found, seen = [0.0], [1.0]
    if not is_cut_out(measurement):
        return 0.0, 1.0
    for case, axis in np.ndindex(shares.shape):
        steps, along = np.flatnonzero(loading.load_case == case), shares[case, 1 - axis]
        if along < 1.0 and loading.measured[steps, axis, axis].any():
            free = has_free_sides(loading, case, axis)
            found.append(section(mesh, P[steps[-1]], axis, along, free).uncertainty)
            seen.append(float(along))
    return max(found), min(seen)


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


def _zero_after(measurement: xr.Dataset, loading: Loading, by_zero, weights, prior: float) -> float:
    """Uncertainty of the zero once the forces of the load steps are known, root mean square over the load cases.

    A zero counts more the smaller the force. What a law bends between the steps is free, and so is the level. Errors of
    the other inputs are the same for every step, but for those of the pairing.

    Args:
        by_zero: relative error of each force by a zero of 1.
        weights: of the steps.
        prior: uncertainty of the zero.
    """
    strain = np.linalg.norm(measurement["H"].values, axis=(1, 2))
    single = np.hypot(float(measurement.attrs["force_uncertainty"]), _open(measurement, RELAXATION_OPEN))
    pairing, variance = _open(measurement, PAIRING_OPEN), 0.0
    for case in np.unique(loading.load_case):
        own = np.flatnonzero((loading.load_case == case) & (by_zero > 0.0))
        if len(own):
            free = strain[own, None] ** BENDS / strain[own].max() ** BENDS
            covariance = np.diag(single[own] ** 2) + np.outer(pairing[own], pairing[own])
            variance += weights[own].sum() * posterior_uncertainty(prior, by_zero[own], covariance, free) ** 2
    return float(np.sqrt(variance))


def _open(measurement: xr.Dataset, name: str) -> Float[np.ndarray, " step"]:
    """What a record leaves open of the force of every step, over the force."""
    return measurement[name].values if name in measurement else np.zeros(measurement.sizes["load_step"])


def table(budget: LevelBudget) -> list[dict]:
    """The budget as rows for a file; the last one is the total."""
    rows = [
        {"input": part.name, "type": part.type}
        | {key: getattr(part, key) for key in ("prior", "posterior", "level")}
        | {"told_by": part.told_by}
        for part in budget.parts
    ]
    total = {"input": TOTAL, "type": "", "prior": None, "posterior": budget.level, "level": budget.level}
    return [*rows, total | {"told_by": ""}]


def judge_level(budget: LevelBudget | None, threshold: Threshold) -> Criterion:
    """The criterion of a verdict, with every part and the cost of measuring a part of the width."""
    name = "level"
    if budget is None:
        return not_judged(name, "No force was recorded, so the level is a convention.")
    judged = limited(name, "The level of the stress is known to", budget.level, threshold)
    parts = ", ".join(f"{part.name} {percent(part.level)}" for part in budget.largest)
    told = ", ".join(part.name for part in budget.parts if part.told_by)
    sentence = f"{judged.sentence} Contributions: {parts or 'none is stated'}."
    if told:
        sentence += f" The test tells of {told}."
    if budget.seen < 1.0:
        sentence += (
            f" The points cover {percent(budget.seen)} of the width, and the strip beside them adds "
            f"{percent(budget.of(SHARE).level)}."
        )
    return replace(judged, sentence=sentence)
