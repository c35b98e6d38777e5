"""The criteria of a verdict."""

import dataclasses
import json
import math
from collections.abc import Mapping, Sequence

import xarray as xr

from hypernode.data.believed_window import BelievedWindow
from hypernode.data.measurement import displacement_noise, force_uncertainty, is_cut_out, mesh_of
from hypernode.evaluation.compression import judge_compression
from hypernode.evaluation.doubt import Doubt, judge_modes, judge_volume
from hypernode.evaluation.explained import judge_displacements, judge_left_out, judge_places, of_few_numbers
from hypernode.evaluation.level_budget import SHARE, LevelBudget, judge_level, level_of
from hypernode.evaluation.limits import limited, not_judged, percent
from hypernode.evaluation.phases import FLOOR, NOT_JUDGED, SEEN
from hypernode.evaluation.polish import KEPT
from hypernode.evaluation.ratios import Ratio, judge_ratios
from hypernode.evaluation.refuted import Refuted, judge_refuted
from hypernode.evaluation.thresholds import SETTINGS, Settings, Threshold
from hypernode.verdict import Criterion, Ending, Level, Verdict

#: How many phases may be distinguishable, in words.
NUMERALS = {2: "Two", 3: "Three", 4: "Four", 5: "Five"}


def judge_run(
    summary: Mapping[str, object],
    measurement: xr.Dataset,
    constrained: xr.Dataset | None = None,
    settings: Settings = SETTINGS,
    budget: LevelBudget | None = None,
    doubt: Sequence[Doubt] = (),
    where: Refuted | None = None,
) -> Verdict:
    """The verdict on one run.

    Args:
        summary: numbers of its evaluation.
        measurement, constrained: opened files; ``constrained`` is None for a method without an equilibrium field.
        budget: of the level of the stress; None without a recorded force.
        doubt: in every mode of deformation.
        where: the law fails; None where nothing says so.
    """
    uncertainty = max(float(force_uncertainty(measurement).max()), settings.force_uncertainty)
    uncertainty = math.hypot(uncertainty, level_of(budget, SHARE))
    force = Threshold(settings.force.warn * uncertainty, settings.force.fail * uncertainty)
    explained = judge_displacements(summary, constrained, displacement_noise(measurement), settings)
    return Verdict(
        (
            _convergence(summary, explained),
            explained,
            *_window(measurement, constrained, settings),
            judge_places(summary, settings),
            judge_refuted(where, settings),
            _outliers(measurement, settings),
            _forces(summary, measurement, force),
            judge_left_out(constrained, settings),
            _law(summary, constrained, explained, uncertainty, settings),
            _networks(summary, settings),
            _equilibrium(summary, measurement, settings),
            _force_record(measurement),
            _spread(summary, settings),
            judge_level(budget, settings.level),
            judge_modes(list(doubt), settings.spread),
            judge_volume(constrained, list(doubt)),
            judge_compression(summary),
            _inclusion(summary),
            judge_ratios([Ratio(**each) for each in summary.get("stiffness_ratios", ())]),
        )
    )


def _convergence(summary, explained: Criterion) -> Criterion:
    name, ending = "convergence", summary.get("ending")
    if ending is None:
        return not_judged(name, "The method searches for no equilibrium field.")
    if ending == Ending.CONVERGED:
        return Criterion(name, Level.PASSED, "The equilibrium field converged.")
    sentence = f"The equilibrium field did not converge ({ending})"
    too_small = explained.value is not None and explained.value < explained.threshold
    if explained.level is not Level.PASSED and not too_small:
        return Criterion(name, Level.FAILED, f"{sentence}, nor does it explain the displacements.")
    return Criterion(name, Level.WARNED, f"{sentence}.")


def _window(measurement, constrained, settings: Settings) -> tuple[Criterion, ...]:
    """Uncertainty of a correlation window that the identification had to estimate; none if it was stated.

    What a window changes goes with the square of its side, and one of less than a step between points changes nothing.
    """
    found = None if constrained is None else BelievedWindow.read(constrained.attrs)
    if found is None or found.error == 0.0:
        return ()
    side = f"{found.side:.3g} +- {found.error:.1g} {json.loads(measurement.attrs['units'])['length']}"
    sentence = (
        f"No correlation_window is stated; the identification estimated it beside interfaces as {side}. State "
        "the window of the correlation software."
    )
    known = found.side * found.error / max(found.side, mesh_of(measurement).step) ** 2
    level = Level.PASSED if known <= settings.window_known else Level.WARNED
    return (Criterion("window", level, sentence, value=known, threshold=settings.window_known),)


def _outliers(measurement, settings: Settings) -> Criterion:
    name = "outliers"
    if "outliers" not in measurement.attrs:
        return not_judged(name, "The measurement does not say whether points were mistaken.")
    sizes = measurement.sizes
    share = int(measurement.attrs["outliers"]) / (sizes["load_step"] * sizes["node"] * sizes["repeat"])
    return limited(name, "Outliers, which count as lost points, are", share, settings.outliers)


def _forces(summary, measurement, threshold: Threshold) -> Criterion:
    if measurement.attrs["forces"] == "assumed":
        sentence = "No force was recorded: every stress is known up to one factor, and its level is a convention."
        return Criterion("forces", Level.WARNED, sentence)
    return limited("forces", "Edge forces are missed by", summary["edge_force_error_identified"], threshold)


def _law(summary, constrained, explained: Criterion, uncertainty: float, settings: Settings) -> Criterion:
    """Whether a law follows the forces.

    One material for the whole sheet tells this of any field. A sheet of unlike materials follows no such course, so few
    materials that explain the displacements tell it better.
    """
    name = "law"
    if constrained is None:
        return not_judged(name, "The method fits no basis of terms to the forces.")
    misfits = json.loads(constrained.attrs["homogeneous_force_misfit"])
    # The maximum of Python's own loses what is not a number.
    worst = max(misfits) if all(map(math.isfinite, misfits)) else math.nan
    own = summary["edge_force_error_identified"]
    # What forces are uncertain by is no error of a law.
    limit = Threshold(max(settings.law.warn, uncertainty), max(settings.law.fail, uncertainty))
    if of_few_numbers(constrained) and explained.level is Level.PASSED and own < worst:
        return limited(name, "The materials that explain the displacements miss the forces by", own, limit)
    return limited(name, "The closest material of the basis misses the forces by", worst, limit)


def _networks(summary, settings: Settings) -> Criterion:
    name = "networks"
    if "network_error" not in summary:
        return not_judged(name, "The method has no equilibrium field that networks learn.")
    if summary.get("polish") == KEPT:
        return _polished(name, summary)
    words = "Networks miss the stress of the equilibrium field by"
    return limited(name, words, summary["network_error"], settings.networks)


def _polished(name: str, summary) -> Criterion:
    """Whether polished networks predict held-out load steps better than the networks before polishing."""
    misses = [
        f"{summary[f'held_out_{what}_misfit']:.3g} of their noise, not {summary[f'held_out_{what}_misfit_before']:.3g}"
        for what in ("displacement", "force")
    ]
    sentence = f"Polished networks miss held-out displacements by {misses[0]}, and held-out forces by {misses[1]}"
    if summary["polish_ending"] == Ending.CONVERGED:
        return Criterion(name, Level.PASSED, f"{sentence}.")
    return Criterion(
        name, Level.WARNED, f"{sentence}, but the polishing did not converge ({summary['polish_ending']})."
    )


def _equilibrium(summary, measurement, settings: Settings) -> Criterion:
    name = "equilibrium"
    if is_cut_out(measurement):
        # The gap takes the sides of the grid as free, and those of a cut carry forces that nobody knows.
        return not_judged(name, "The grid is cut out of a larger sheet, and the forces on its sides are not known.")
    gap = summary["equilibrium_gap_identified"]
    return limited(name, "The stress is out of equilibrium by", gap, settings.equilibrium)


def _force_record(measurement) -> Criterion:
    name, findings = "force record", measurement.attrs.get("force_findings")
    if findings is None:
        return not_judged(name, "The measurement holds no checks of a force record.")
    findings = json.loads(findings)
    if not findings:
        return Criterion(name, Level.PASSED, "The checks of the force record found nothing.", value=0.0, threshold=0.0)
    return Criterion(
        name, Level.WARNED, f"Force record: {' '.join(findings)}", value=float(len(findings)), threshold=0.0
    )


def _spread(summary, settings: Settings) -> Criterion:
    name = "uncertainty"
    if "spread_of_materials" not in summary:
        return not_judged(name, "There are no posterior samples.")
    words = "By posterior samples the standard uncertainty of the stiffness is"
    judged = limited(name, words, summary["spread_of_materials"], settings.spread)
    # Where a line runs inside a cell no camera tells. That is no doubt of the materials beside it.
    cut = f" With that of cells that interfaces may cut it is {percent(summary['spread'])}."
    return dataclasses.replace(judged, sentence=judged.sentence + cut)


def _inclusion(summary) -> Criterion:
    """Whether an inclusion is distinguishable; both answers pass."""
    name = "inclusion"
    if summary.get("inclusion", NOT_JUDGED) == NOT_JUDGED:
        return not_judged(name, "The noise of the stiffness is unknown: there are no posterior samples.")
    seen, needed, count = (summary[key] for key in ("contrast_seen", "contrast_needed", "phases_found"))
    chance = f"{'noise' if needed > FLOOR else 'finite elements'} {percent(needed)}"
    split = "they explain" if count == 2 else "a split in two explains"
    explained = f"{split} {percent(seen)} of the stiffness, and {chance}"
    if summary["inclusion"] == SEEN:
        sentence = f"{NUMERALS[count]} phases are distinguishable: {explained}."
    else:
        contrast = summary["detectable_contrast"]
        visible = f"contrasts above {percent(contrast)} would have been seen of a fifth of the sheet"
        if "smallest_phase" in summary:
            visible += f", and a phase twice as stiff from {percent(summary['smallest_phase'])} of it on"
        sentence = f"No inclusion is distinguishable: {explained}; {visible}."
    return Criterion(name, Level.PASSED, sentence, value=seen, threshold=needed)
