"""The forces of a specimen's load steps, checked before anything is computed with them."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from hypernode.config.specimens import Specimen
from hypernode.dic.errors import DicError
from hypernode.dic.force_checks import Finding, check_rest, check_rise, check_stiffness, check_units
from hypernode.dic.force_clock import ClockOffset, agreed_offset, check_clock, estimate_offsets
from hypernode.dic.force_matching import PullRecord, pull_record
from hypernode.dic.force_record import read_force_record
from hypernode.progress import say


@dataclass(frozen=True)
class Forces:
    """Forces of the load steps.

    Attributes:
        pull: the record, in its own clock, with that of the frames.
        time: of every load step in the clock of the record [s].
        force: of every load step [N].
        findings: sentences on what is strange about them.
    """

    pull: PullRecord
    time: Float[np.ndarray, " step"]
    force: Float[np.ndarray, " step"]
    findings: tuple[str, ...]


def import_forces(
    specimen: Specimen,
    axis: int,
    numbers: Int[np.ndarray, " frame"],
    stretch: Float[np.ndarray, " frame"],
    chosen: Int[np.ndarray, " step"],
) -> Forces:
    """Read the record of a specimen, match it with the frames and check it.

    Args:
        specimen: what the configuration says of it.
        axis: of the pull: 0 or 1.
        numbers: of the frames that were read, the reference first.
        stretch: mean stretch of each along the pull, NaN where it is not known.
        chosen: numbers of the frames that are load steps.

    Raises:
        DicError: the record cannot be read, does not reach a load step, or holds what no sheet can give.
    """
    path = Path(specimen.folder) / specimen.force_file
    record = read_force_record(
        path, specimen.force_format, specimen.force_channel, specimen.force_set, specimen.force_cycle
    )
    channels = ", ".join(record.channels)
    say("import", specimen.folder, f"{path.name}: read as {record.dialect.name} ({record.dialect.program}): {channels}")
    given = specimen.force_time_offset
    seconds = given if isinstance(given, float) else 0.0
    first = (int(numbers[0]), specimen.first_frame_time + seconds, specimen.frame_rate)
    pull = pull_record(record, "xy"[axis], specimen.force_offset, *first)
    seen = (numbers <= chosen.max()) & np.isfinite(stretch)
    findings = []
    if pull.image is None:
        offsets = _offsets(pull, numbers[seen], stretch[seen])
        if given == "estimate":
            pull, sentence = _shifted(pull, offsets)
            findings.append(Finding(sentence, False))
        else:
            findings += check_clock(offsets, specimen.frame_rate, accepted=given is not None)
    time, force = pull.times(chosen), pull.forces(chosen)
    section = (specimen.width, specimen.height)[1 - axis] * specimen.thickness
    step_stretch = np.array([stretch[numbers == number][0] for number in chosen])
    known, forces = _within(pull, numbers[seen])
    findings += check_rise(stretch[seen][known], forces)
    findings += check_units(pull.time, pull.force)
    findings += check_stiffness(step_stretch, force, section, chosen)
    findings += check_rest(forces) if known[0] else []
    return Forces(pull, time, force, _reported(specimen.folder, path, findings))


def _offsets(pull: PullRecord, numbers, stretch) -> list[ClockOffset]:
    return estimate_offsets(pull.times(numbers), stretch, pull.time, pull.force, pull.displacement)


def _shifted(pull: PullRecord, offsets: list[ClockOffset]) -> tuple[PullRecord, str]:
    """The pull with the estimated offset of its clock, and the sentence that says so."""
    offset = agreed_offset(offsets)
    if offset is None:
        told = " and ".join(map(str, offsets)) or "neither the crosshead nor the onset of the force tells it"
        raise DicError(f"{pull.record.path}: force_time_offset: estimate: {told}: give the offset in seconds")
    return replace(pull, first_time=pull.first_time + offset.seconds), f"offset of the force record: {offset}"


def _within(pull: PullRecord, numbers) -> tuple[np.ndarray, np.ndarray]:
    """(which frames the record reaches, their forces)."""
    if pull.image is None:
        time = pull.times(numbers)
        known = (time >= pull.time[0]) & (time <= pull.time[-1])
    else:
        known = np.isin(numbers, pull.image)
    return known, pull.forces(numbers[known]) if known.any() else np.empty(0)


def _reported(folder: str, path: Path, findings: list[Finding]) -> tuple[str, ...]:
    """The sentences of what is only strange, each said; whatever is refused comes together in one error."""
    refused = [finding.sentence for finding in findings if finding.refused]
    if refused:
        raise DicError(f"{path}: " + "; and ".join(refused))
    for finding in findings:
        say("import", folder, f"warning: {path.name}: {finding.sentence}")
    return tuple(finding.sentence for finding in findings)
