"""Whether the field explains the displacements to their noise, or to a deformation that is too small to matter.

A misfit beyond chance shows an error of the model. Its effect on the stress depends on the deformation that it amounts
to. A precise camera sees differences that hardly change the stress.
"""

import dataclasses
import json
import math

import numpy as np
import xarray as xr
from jaxtyping import Bool

from hypernode.data.believed_noise import BelievedNoise, NoiseSource
from hypernode.data.measurement import mesh_of
from hypernode.evaluation.limits import limited, not_judged, percent
from hypernode.evaluation.thresholds import Settings, Threshold
from hypernode.verdict import Criterion, Level

#: What a level becomes where what is missed is too small to count.
LESS = {Level.FAILED: Level.WARNED, Level.WARNED: Level.PASSED}


def missed_deformation(misfit, constrained: xr.Dataset):
    """Deformation between neighbouring points that corresponds to the misfit beyond noise, over the largest of the
    test.

    Args:
        misfit: root mean square over the noise, a number or an array.
        constrained: an opened field.
    """
    return np.sqrt(np.maximum(misfit**2 - 1.0, 0.0)) * float(constrained.attrs["noise_deformation"])


def beside_corners(constrained: xr.Dataset) -> Bool[np.ndarray, " cell"]:
    """Cells around which a local mean contains a corner of the grid; they say nothing of the material.

    Where a clamp ends the stress has no bound, and no element follows it. On a grid of four cells a side all are beside
    corners, and none is left out.
    """
    mesh = mesh_of(constrained)
    corners = [f(mesh.nodes @ way) for f in (np.argmin, np.argmax) for way in ((1.0, 1.0), (1.0, -1.0))]
    near = mesh.around()[:, corners].sum(axis=1).A1 > 0
    return near & ~near.all()


def unexplained_share(constrained: xr.Dataset, settings: Settings) -> float:
    """Share of the cells whose misfit exceeds chance and amounts to a relevant deformation, corners apart."""
    # Local misfits are over that of the sheet where that is more than noise.
    usual = max(float(json.loads(constrained.attrs["misfits"])["displacement"]), 1.0)
    counts = missed_deformation(usual * constrained["local_misfit"], constrained) > settings.deformation
    return float((((constrained["unexplained"] == 1) & counts).values & ~beside_corners(constrained)).mean())


def of_few_numbers(constrained: xr.Dataset) -> bool:
    """Whether a field is of few materials, or of one that changes gradually, and not of cells of their own."""
    return int(constrained.attrs.get("materials", 0)) > 0 or constrained.attrs.get("gradual") == "true"


def judge_displacements(summary, constrained: xr.Dataset | None, noise: float, settings: Settings) -> Criterion:
    """Criterion for the root mean square misfit over the noise, one by chance; without noise it may be smaller.

    Args:
        noise: of a displacement, as the measurement has it; 0 where there is none.
    """
    name = "displacements"
    if constrained is None:
        return not_judged(name, "The method computes no displacements.")
    observed = int(constrained.attrs["observed_displacements"])
    noisy = json.loads(constrained.attrs["noise_rules_displacements"])
    value = float(summary["displacement_misfit"])
    judged = _misfit(name, value, noisy, observed, of_few_numbers(constrained), settings)
    judged = _as_it_counts(judged, value, constrained, settings) if noisy else judged
    if judged.level is Level.PASSED and not noisy and noise > 0.0 and not of_few_numbers(constrained):
        judged = _over_noise(judged, value, noise, constrained, settings)
    believed = BelievedNoise.read(constrained.attrs)
    if judged.level is not Level.PASSED:
        return judged
    if not settings.misfit_low <= believed.factor <= 1.0 / settings.misfit_low:
        return _other_noise(name, believed.factor, constrained, settings)
    if believed.source is NoiseSource.FRAMES:
        sentence = (
            "Frames and field agree that the stated noise is wrong; the field was identified with their estimate."
        )
        return Criterion(name, Level.WARNED, sentence, value=value, threshold=judged.threshold)
    return judged


def _other_noise(name: str, factor: float, constrained: xr.Dataset, settings: Settings) -> Criterion:
    """The criterion where the field was identified with another noise than the assumed one.

    A field of few numbers cannot fit noise: it shows that less was there than was assumed. More may be what the model
    misses, and counts by the deformation that it amounts to.
    """
    sentence = f"The noise is {factor:.2g} times the assumed one; the field was identified with that noise."
    harmless = factor < 1.0 and of_few_numbers(constrained)
    if factor > 1.0:
        # Misfits are over the larger noise.
        missed = math.sqrt(1.0 - factor**-2) * float(constrained.attrs["noise_deformation"])
        harmless = missed <= settings.deformation
        sentence += f" What it has more amounts to {percent(missed)} of the deformation."
    level = Level.PASSED if harmless else Level.WARNED
    return Criterion(name, level, sentence, value=factor, threshold=settings.misfit_low)


def _over_noise(
    judged: Criterion, misfit: float, noise: float, constrained: xr.Dataset, settings: Settings
) -> Criterion:
    """The criterion, which warns where cells of their own leave more than noise.

    Few materials did not explain the sheet. What cells leave is within what elements may make that an interface cuts.
    A law that is wrong may leave it as well.
    """
    sigma = float(constrained.attrs["displacement_sigma"])
    ratio = misfit * sigma / noise
    missed = math.sqrt(max(ratio**2 - 1.0, 0.0)) * noise / sigma * float(constrained.attrs["noise_deformation"])
    if ratio <= 1.0 + settings.noise_known or missed <= settings.deformation:
        return judged
    sentence = (
        f"Displacements are missed by {ratio:.2g} times their noise, which is {percent(missed)} of the deformation. "
        "Finite elements that interfaces cut may err so, and so may the law."
    )
    return Criterion(judged.name, Level.WARNED, sentence, value=ratio, threshold=1.0 + settings.noise_known)


def _misfit(name: str, value: float, noisy: bool, observed: int, few: bool, settings: Settings) -> Criterion:
    words = f"The misfit of displacements over {'their noise' if noisy else 'the error of finite elements'} is"
    if noisy and value < settings.misfit_low:
        # A field of few numbers cannot fit noise.
        level, fitted = (Level.PASSED, "") if few else (Level.WARNED, ", or is fitted")
        sentence = f"{words} {value:.2f}, less than {settings.misfit_low:.2f}: the noise is stated too large{fitted}."
        return Criterion(name, level, sentence, value=value, threshold=settings.misfit_low)
    by_chance = settings.chance / math.sqrt(2.0 * observed) if noisy else 0.0
    threshold = Threshold(1.0 + max(settings.noise_known, by_chance), settings.misfit_fail)
    return limited(name, words, value, threshold, "{:.2f}".format)


def _as_it_counts(judged: Criterion, misfit: float, constrained: xr.Dataset, settings: Settings) -> Criterion:
    """The criterion lowered by one level if its misfit amounts to an irrelevant deformation."""
    missed = float(missed_deformation(misfit, constrained))
    if misfit <= 1.0 or judged.level not in LESS or not missed <= settings.deformation:
        return judged
    sentence = f"{judged.sentence} It amounts to {percent(missed)} of the deformation, which hardly changes the stress."
    return dataclasses.replace(judged, level=LESS[judged.level], sentence=sentence)


def judge_places(summary, settings: Settings) -> Criterion:
    """Criterion for the part of the sheet whose misfit exceeds chance and amounts to a relevant deformation."""
    name = "places"
    if "unexplained_share" not in summary:
        return not_judged(name, "Displacements have no noise of points, so a local misfit cannot be judged.")
    share = summary["unexplained_share"]
    words = f"Displacements are missed by more than chance and {percent(settings.deformation)} of the deformation"
    words += ", corners apart"
    words += f", up to {summary['largest_local_misfit']:.2f} times as much, in" if share else " in"
    return limited(name, words, share, settings.places, lambda v: f"{percent(v)} of the sheet")


def judge_left_out(constrained: xr.Dataset | None, settings: Settings) -> Criterion:
    """Criterion for the largest load steps, predicted from the others: the worse of displacements and forces."""
    name = "prediction"
    if constrained is None:
        return not_judged(name, "The method predicts no load step from others.")
    if "left_out" not in constrained.attrs:
        return not_judged(name, "No load step can be left out: there is one a load case, or nothing is left to chance.")
    left_out = json.loads(constrained.attrs["left_out"])
    words = "Over noise and the field's spread, {} of the largest load steps, predicted from the others, are missed by"
    by_chance = 1.0 + max(settings.noise_known, settings.chance / math.sqrt(2.0 * left_out["directions"]))
    limit = Threshold(by_chance, settings.misfit_fail * by_chance)
    of_u = limited(name, words.format("displacements"), left_out["displacement"], limit, "{:.2f}".format)
    if of_u.level is not Level.PASSED and left_out["deformation"] is not None:
        of_u = _as_predicted(of_u, left_out["deformation"], settings)
    judged = [of_u]
    if left_out["force"] is not None:
        judged.append(limited(name, words.format("forces"), left_out["force"], settings.force, "{:.2f}".format))
    return max(judged, key=lambda each: each.level.rank)


def _as_predicted(judged: Criterion, deformation: float, settings: Settings) -> Criterion:
    """The criterion with the level of the deformation that the prediction misses; what is no number has failed."""
    if judged.value is None:
        return judged
    counted = limited(judged.name, "", deformation, settings.predicted).level
    hardly = ", within what an answer may be off" if counted is Level.PASSED else ""
    sentence = f"{judged.sentence} It amounts to {percent(deformation)} of the deformation{hardly}."
    return dataclasses.replace(judged, level=counted, sentence=sentence)
