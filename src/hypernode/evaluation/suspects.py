"""The likeliest causes of what a verdict warns of, each with its evidence.

Forces are told apart by their course, displacements by their pattern, and the level by its budget. A cause is named
only for criteria that are not met.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from hypernode.data.measurement import mesh_of
from hypernode.evaluation.force_courses import LAW, PAIRING, SCATTER, ZERO, amplitude, channels, probabilities
from hypernode.evaluation.level_budget import LevelBudget
from hypernode.evaluation.limits import percent
from hypernode.evaluation.phases import phase_numbers
from hypernode.evaluation.residual_patterns import AT_LINES, Pattern, pattern_of
from hypernode.verdict import Criterion, Level, Suspect, Verdict

#: Criteria that each kind of evidence speaks to.
OF_DISPLACEMENTS = ("convergence", "displacements", "places", "refuted", "prediction")
OF_FORCES = ("forces", "law", "prediction")
OF_LEVEL = ("level",)
#: Weight below which a cause is not named, and how many are named at most.
FAINT, NAMED = 0.1, 4
#: A force of one step is seldom known to better than a thousandth.
FORCE_SCATTER = 1e-3
#: Mean square of residuals beyond that of noise from which a pattern is looked for: noise is known to a twentieth.
LOOKED_FOR = 0.1
#: Cells within which a line is said to run: a displacement changes over the elements on both sides.
NEAR_LINE = 1.5


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """The numbers by which suspects are told apart.

    Attributes:
        pattern: of the residuals of displacements; None without a field or without noise.
        channels: courses of the forces.
        budget: of the level, None where no force was recorded.
        too_noisy: misfit of displacements over their assumed noise.
        predicted: misfit of displacements of the largest steps, predicted from the others; None where there are none.
        slope: how the stiffness of one material changes, (change from side to side, share that is a plane), or None.
    """

    pattern: Pattern | None
    channels: tuple
    budget: LevelBudget | None
    too_noisy: float
    predicted: float | None
    slope: tuple[float, float] | None


def evidence_of(
    summary: Mapping,
    variables: Mapping,
    measurement: xr.Dataset,
    constrained: xr.Dataset | None,
    budget: LevelBudget | None,
) -> Evidence:
    """Compute the evidence on one run.

    Args:
        summary, variables: of its judgement.
        measurement, constrained: opened files; no constrained field where the method has none.
    """
    return Evidence(
        pattern=None if constrained is None else _pattern(measurement, constrained, variables),
        channels=tuple(channels(measurement, variables["edge_force_at_identified"])),
        budget=budget,
        too_noisy=float(summary.get("displacement_misfit", 1.0)),
        predicted=summary.get("left_out_displacement_misfit"),
        slope=_slope(mesh_of(measurement), variables) if summary.get("phases_found") == 1 else None,
    )


def _pattern(measurement, constrained, variables) -> Pattern | None:
    if "residual" not in constrained:
        return None
    mesh, case = mesh_of(measurement), measurement["load_case"].values
    residual = constrained["residual"].values
    deformation = np.linalg.norm(measurement["H"].values, axis=(1, 2))
    # What a law misses of one load case does not repeat in another: the one that is missed most tells.
    own = case == max(case, key=lambda each: np.nanmean(residual[case == each] ** 2))
    return pattern_of(mesh, residual[own], deformation[own], _lines(mesh, constrained, variables))


def _lines(mesh, constrained, variables):
    """Nodes beside a line between materials."""
    if "interface_distance" in constrained:
        return (np.abs(constrained["interface_distance"].values) < NEAR_LINE).any(axis=0)
    pairs, phase = mesh.touching(), phase_numbers(variables)
    cells = np.unique(pairs[phase[pairs[:, 0]] != phase[pairs[:, 1]]])
    near = np.zeros(len(mesh.nodes), bool)
    near[mesh.cells[cells].ravel()] = True
    return near


def _slope(mesh, variables) -> tuple[float, float] | None:
    """(relative change of the stiffness along a plane from side to side, share of its squares that the plane tells)."""
    stiffness = np.asarray(variables["trace_P"])
    if not (np.isfinite(stiffness) & (stiffness > 0.0)).all():
        return None
    y = np.log(stiffness)
    y = y - y.mean()
    X = (mesh.centres - mesh.centres.mean(axis=0)) / np.ptp(mesh.nodes, axis=0)
    plane = X @ np.linalg.lstsq(X, y, rcond=None)[0]
    total = float(y @ y)
    return (float(np.ptp(plane)), 1.0 - float(((y - plane) ** 2).sum()) / total) if total > 0.0 else None


def with_suspects(verdict: Verdict, evidence: Evidence) -> Verdict:
    """A verdict with the likeliest causes of what it does not pass."""
    found: list[tuple[int, Suspect]] = []
    kinds = (
        (OF_FORCES, forces_suspects(evidence.channels)),
        (OF_DISPLACEMENTS, displacement_suspects(evidence.pattern, evidence.too_noisy)),
        (("prediction",), _prediction_suspects(evidence)),
        (OF_LEVEL, level_suspects(evidence.budget)),
        ((*OF_DISPLACEMENTS, *OF_LEVEL, "uncertainty"), slope_suspects(evidence.slope, evidence.budget)),
    )
    for names, suspects in kinds:
        rank = _rank(verdict.criteria, names)
        if rank:
            found += [(rank, each) for each in suspects if each.weight >= FAINT]
    return replace(verdict, suspects=_ranked(found))


def _rank(criteria: Iterable[Criterion], names) -> int:
    """How bad the worst of some criteria is that is not met; 0 where all are."""
    return max((c.level.rank - Level.PASSED.rank for c in criteria if c.unmet and c.name in names), default=0)


def _ranked(found: list[tuple[int, Suspect]]) -> tuple[Suspect, ...]:
    """The likeliest first, every name once: of two the larger weight counts, and both sentences stand."""
    by_name: dict[str, tuple[int, Suspect]] = {}
    for rank, each in sorted(found, key=lambda pair: (-pair[0], -pair[1].weight)):
        if each.name not in by_name:
            by_name[each.name] = rank, each
            continue
        first_rank, first = by_name[each.name]
        if each.sentence != first.sentence:
            first = Suspect(each.name, max(first.weight, each.weight), f"{first.sentence} {each.sentence}")
        by_name[each.name] = first_rank, first
    ordered = sorted(by_name.values(), key=lambda pair: (-pair[0], -pair[1].weight))
    return tuple(each for _, each in ordered[:NAMED])


def forces_suspects(of: Iterable) -> list[Suspect]:
    """Causes told by the courses of the forces. One cause is assumed for all channels."""
    every = list(of)
    if not every:
        return []
    names = (ZERO, PAIRING, LAW, SCATTER)
    told = [probabilities(each, FORCE_SCATTER) for each in every]
    # A channel that scatters says nothing of a cause that another one shows.
    shown = [name for name in names if any(name in each for each in told)]
    joint = {name: float(np.prod([each.get(name, each[SCATTER]) for each in told])) for name in shown}
    total = sum(joint.values()) or 1.0
    largest = max(every, key=lambda each: np.abs(each.force).max())
    return [Suspect(_CALLED.get(name, name), joint[name] / total, _force_words(name, largest)) for name in shown]


_CALLED = {SCATTER: "noise"}


def _force_words(name: str, channel) -> str:
    most = np.abs(channel.force).max()
    if name == SCATTER:
        return "Forces are missed from step to step without a course."
    missed = amplitude(channel, name)
    if name == ZERO:
        return f"What forces are missed by is one force in every step, {percent(missed / most)} of the largest."
    if name == PAIRING:
        return f"What forces are missed by is as their rate, as if pictures were {missed:.2g} off in time (s or steps)."
    return f"What forces are missed by grows with the stretch, to {percent(missed)} over the test."


def displacement_suspects(pattern: Pattern | None, misfit: float) -> list[Suspect]:
    """Causes told by the pattern of the residuals of displacements."""
    if pattern is None:
        return []
    if pattern.beyond < LOOKED_FOR:
        low = misfit < 1.0
        words = "Displacements are missed by less than their noise, which is stated too large or is fitted."
        return [Suspect("noise", 1.0, words)] if low else []
    total = 1.0 + pattern.beyond
    # Of one step nothing repeats: what neighbours share stands for it.
    common = max(pattern.smooth, 0.0) if pattern.repeats is None else pattern.repeats
    share = min(common * total / pattern.beyond, 1.0)
    what = f"{percent(share)} of what displacements are missed by beyond noise"
    found = [Suspect("noise", 1.0 - share, f"Only {what} is the same in all steps.")]
    if pattern.growth == 0 and pattern.repeats is not None:
        words = f"{what.capitalize()} is the same in all steps and does not grow: an error of the reference picture."
        return [Suspect("noise", share, words)]
    smooth = min(max(pattern.smooth, 0.0) / max(common, 1e-9), 1.0)
    lines = pattern.lines_share if (pattern.at_lines or 0.0) > AT_LINES else 0.0
    camera = (1.0 - lines) * pattern.affine if pattern.affine > 0.5 else 0.0
    rest = share * max(1.0 - lines - camera, 0.0)
    if lines:
        words = f"Beside lines the mean square of what is missed is {pattern.at_lines:.2g} times that elsewhere."
        found.append(Suspect("mesh", share * lines, words))
    if camera:
        words = f"{percent(pattern.affine)} of what is missed is what a camera makes that moves, turns or is farther."
        found.append(Suspect("camera", share * camera, words))
    words = f"{what.capitalize()} is the same in all steps, smooth over the sheet, and grows "
    if pattern.growth == 2:
        found.append(Suspect("law", rest * smooth, words + "otherwise than the deformation."))
    else:
        # A direction or a volume that a law lacks, and a thickness, look alike.
        found.append(Suspect("law", 0.55 * rest * smooth, words + "with the deformation: a direction or volume."))
        found.append(Suspect("thickness", 0.45 * rest * smooth, words + "with the deformation: a thickness or edge."))
    return found


def _prediction_suspects(evidence: Evidence) -> list[Suspect]:
    misfit, known = evidence.predicted, evidence.too_noisy
    if misfit is None or misfit <= max(known, 1.0):
        return []
    words = f"Steps that were left out are missed by {misfit:.2f} of what chance makes, and fitted ones by {known:.2f}."
    return [Suspect("law", 1.0 - (max(known, 1.0) / misfit) ** 2, words)]


def level_suspects(budget: LevelBudget | None) -> list[Suspect]:
    """Causes told by the largest parts of the level's budget."""
    if budget is None or not budget.level:
        return []
    total = budget.level**2
    return [
        Suspect(part.name, part.level**2 / total, f"It leaves {percent(part.level)} of the level open.")
        for part in budget.largest
    ]


def slope_suspects(slope: tuple[float, float] | None, budget: LevelBudget | None) -> list[Suspect]:
    """A thickness that is not mapped makes one material stiffer from side to side."""
    if slope is None:
        return []
    change, share = slope
    known = 0.01 if budget is None else max(budget.of("thickness").prior, 0.01)
    if share < 0.5 or change < 2.0 * known:
        return []
    words = f"The stiffness changes by {percent(change)} from side to side, {percent(share)} of it along a plane."
    return [Suspect("thickness", share, words)]
