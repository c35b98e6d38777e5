"""How far the stress is known in every mode of deformation, within what a test has seen and beyond.

A test tells the stress of the deformations that it makes. Doubt in others is from samples of the kept law, and from
laws that explain the test as well. Where forces of left-out load steps are missed by more than that, all of it is as
much larger. Networks that miss the field they learnt and the level of the forces join it.
"""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.evaluation.limits import not_judged, percent
from hypernode.evaluation.probes import Probe
from hypernode.evaluation.thresholds import Threshold
from hypernode.material.domain_file import domain_of
from hypernode.material.field import Material
from hypernode.material.files import material_of, posterior_material
from hypernode.material.open_files import open_materials
from hypernode.mechanics.modes import MODES, mode_gradients
from hypernode.verdict import Criterion, Level

#: Modes that are asked for: those at a common F, and a pull along each axis with free sides.
ASKED = ("equibiaxial", "uniaxial_x", "uniaxial_y", "strip_x", "strip_y", "shear")
#: Stretches over the largest of the test, less one: half way, all of it, and half as much again.
REACHES = (0.5, 1.0, 1.5)
#: Spread from which the test says little of a mode: two of it are a fifth, as phases that count differ by.
SAYS_LITTLE = 0.1


@dataclass(frozen=True, kw_only=True)
class Doubt:
    """Of one mode at one stretch; all numbers are relative to the size of the stress.

    Attributes:
        mode, stretch: of the deformation.
        reach: stretch over the largest of the test, less one.
        inside: whether the test has seen all of it.
        spread: by samples of the kept law.
        by_law: by laws that explain the test as well, by the term that each has more.
        missed: factor by which forces of left-out load steps are missed over noise and spread; 1 where by no more.
        networks: what networks miss of the field that they learnt.
        level: by the level of the forces.
    """

    mode: str
    stretch: float
    reach: float
    inside: bool
    spread: float
    by_law: Mapping[str, float]
    missed: float
    networks: float
    level: float

    @property
    def other_laws(self) -> float:
        """By the widest of the other laws; any of them may be the sheet's."""
        return max(self.by_law.values(), default=0.0)

    @property
    def total(self) -> float:
        """All together, as standard uncertainties add, with the law's own as large as predictions show it to be."""
        of_law = self.missed**2 * (self.spread**2 + self.other_laws**2)
        return float(np.sqrt(of_law + self.networks**2 + self.level**2))

    def stored(self) -> dict:
        """As a file holds it."""
        return asdict(self) | {"other_laws": self.other_laws, "total": self.total}


def doubts(
    files: Mapping[str, xr.Dataset], X: Float[np.ndarray, "cell 2"], largest: float, level: float
) -> list[Doubt]:
    """The doubt in every mode; none of a method without samples.

    Args:
        files: opened ``constrained``, where the method has one, and ``material``.
        X: centres of the cells.
        largest: stretch of the test.
        level: relative uncertainty of the level that samples do not know.
    """
    constrained = files.get("constrained")
    samples = None if constrained is None else posterior_material(constrained)
    if samples is None:
        return []
    field, count = material_of(constrained), constrained.sizes["posterior_sample"]
    learnt = material_of(files["material"]) if files["material"].attrs["material_kind"] == "node" else None
    others, domain, found = open_materials(constrained), domain_of(constrained), []
    missed = max(json.loads(constrained.attrs.get("left_out", "{}")).get("force") or 1.0, 1.0)
    for mode in ASKED:
        for reach in REACHES:
            stretch = 1.0 + reach * (largest - 1.0)
            probe = _probe(field, X, mode, stretch)
            best = probe.read(field, X)
            size = np.sqrt(np.nanmean(np.sum(best**2, axis=1))) if np.isfinite(best).any() else 0.0
            if not (np.isfinite(size) and size > 0.0):
                # No cell has such a state.
                continue
            rms = {t: farther_half(_away(probe.read(each, X, n), best)) / size for t, (each, n) in others.items()}
            networks = 0.0 if learnt is None else _rms(probe.read(learnt, X), best) / size
            spread = _rms(probe.read(samples, X, count), best) / size
            inside = domain is None or bool(domain.inside(probe.F[probe.reached]).all())
            found.append(
                Doubt(
                    mode=mode,
                    stretch=stretch,
                    reach=reach,
                    inside=inside,
                    spread=spread,
                    by_law=rms,
                    missed=missed,
                    networks=networks,
                    level=level,
                )
            )
    return found


def _probe(field: Material, X, mode: str, stretch: float) -> Probe:
    if mode in MODES:
        return Probe.common(mode_gradients([stretch])[MODES.index(mode), 0], len(X))
    return Probe.uniaxial(field, X, stretch, int(mode.endswith("y")))


def _away(values, best) -> Float[np.ndarray, " sample"]:
    """Root mean square distance of each sample from a field."""
    return np.sqrt(np.nanmean(np.sum((values - best) ** 2, axis=1), axis=1))


def _rms(values, best) -> float:
    """The same of all samples."""
    return float(np.sqrt(np.mean(_away(values, best) ** 2)))


def farther_half(distances: Float[np.ndarray, " sample"]) -> float:
    """Root mean square of the larger half of the distances.

    Samples of an open law are of several beginnings, as fibres in four directions. Any of them may be the sheet's, so
    that those which differ more count.
    """
    return float(np.sqrt(np.mean(np.sort(distances)[len(distances) // 2 :] ** 2)))


def judge_modes(found: list[Doubt], known: Threshold) -> Criterion:
    """What is known of deformations that the test need not make; an answer, whatever it is.

    Of a mode that the test has seen the kept law must tell the stress. A material whose fibres no deformation pulls
    may have any.

    Args:
        known: spread by samples of the kept law beyond which that warns and fails.
    """
    name = "other deformations"
    of_test = sorted((each for each in found if each.reach == 1.0), key=lambda each: -each.total)
    if not of_test:
        return not_judged(name, "There are no posterior samples, so that doubt in other deformations is not known.")
    little = [each for each in of_test if each.total > SAYS_LITTLE]
    told = ", ".join(f"{each.mode} {percent(each.total)}" for each in of_test)
    sentence = f"At the stretch of the test the stress is known to: {told}."
    if little:
        terms = sorted({term for each in little for term, rms in each.by_law.items() if rms > SAYS_LITTLE})
        by = f": laws with {', '.join(terms)} explain it as well" if terms else ""
        sentence += f" The test says little of {', '.join(each.mode for each in little)}{by}."
    seen = max((each for each in of_test if each.inside), key=lambda each: each.spread, default=None)
    if seen is None or seen.spread <= known.warn:
        return Criterion(name, Level.PASSED, sentence, value=of_test[0].total, threshold=SAYS_LITTLE)
    level = Level.WARNED if seen.spread <= known.fail else Level.FAILED
    sentence = f"The test has made {seen.mode}, and its own law leaves {percent(seen.spread)} of that open. {sentence}"
    return Criterion(name, level, sentence, value=seen.spread, threshold=known.warn)


def judge_volume(constrained: xr.Dataset | None, found: list[Doubt]) -> Criterion:
    """Whether the test tells if the sheet keeps its volume."""
    name = "volume"
    if constrained is None or not json.loads(constrained.attrs.get("volume_compared", "false")):
        return not_judged(name, "No law of another volume was compared.")
    if "J" in json.loads(constrained.attrs["basis"])["terms"]:
        return Criterion(
            name, Level.PASSED, "The sheet may change its volume: laws that keep it explain the test worse."
        )
    # At the stretch of the test: beyond it every law is a guess.
    of_volume = max((each.by_law.get("J", 0.0) for each in found if each.reach <= 1.0), default=0.0)
    if of_volume > SAYS_LITTLE:
        sentence = (
            f"Whether the volume is kept cannot be told: it leaves {percent(of_volume)} of the stress of a mode open."
        )
    else:
        sentence = f"The volume is kept: laws that change it explain the test worse, or differ by {percent(of_volume)}."
    return Criterion(name, Level.PASSED, sentence, value=of_volume, threshold=SAYS_LITTLE)
