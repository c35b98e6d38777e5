"""What was found out about a folder, in sentences for people."""

import textwrap

import numpy as np

from hypernode.dic.forces.dialects import PULL
from hypernode.dic.forces.record import ForceRecord
from hypernode.inspection.field import Field, Lost, mean_gradients
from hypernode.inspection.folder import Inspection
from hypernode.inspection.known import Remark
from hypernode.inspection.records import Cycle

#: Columns of the words in front of the sentences, and of a line.
_INDENT, _WIDTH = 10, 118
#: Orders of magnitude that a reader compares with, and what makes another of one.
_KNOWN = (
    "gels and soft tissue have up to 0.1 MPa, rubbers and skin 0.1 to 30, plastics some hundred. Only you can tell a "
    "force in kilograms, pounds or grams that is said to be in N: --set force_factor=9.80665, =4.44822 or =0.00980665"
)


def report(seen: Inspection) -> list[str]:
    """Lines for people."""
    rows = [("folder", str(seen.folder))]
    if seen.field is not None:
        rows += _frames(seen.field)
    if seen.load is not None:
        rows += [("motion", _motion(seen)), ("load", _load(seen))]
    rows += [("noise", _noise(seen))] if seen.sheet else []
    rows += _forces(seen) + _import(seen)
    # What the load looks like stands above.
    guesses = {key: why for key, why in seen.known.guesses.items() if key != "load"}
    rows += [("guess", f"{key} = {seen.known.settings[key]}: {why}") for key, why in guesses.items()]
    rows += [("odd", _keyed(each)) for each in seen.known.odd]
    rows += [("missing", _keyed(each)) for each in seen.known.missing]
    end = "it can be imported" if seen.sheet else "it cannot be imported yet: see what is missing"
    return [line for label, text in [*rows, ("so", end)] for line in _wrapped(label, text)]


def _wrapped(label: str, text: str) -> list[str]:
    lines = textwrap.wrap(text, _WIDTH - _INDENT, break_long_words=False, break_on_hyphens=False)
    return [f"{label if k == 0 else '':{_INDENT}}{line}" for k, line in enumerate(lines)]


def _keyed(remark: Remark) -> str:
    return f"{remark.key}: {remark.sentence}" if remark.key else remark.sentence


def _frames(field: Field) -> list[tuple[str, str]]:
    numbers, series = field.numbers, field.series
    steps = f" in steps of {field.every}" if field.every > 1 else ""
    absent = f", without {_some(field.absent, count=field.absent_count)}" if field.absent else ", none missing"
    columns, rows = len(series.x), len(series.y)
    grid = (
        f"{columns} x {rows} points, {field.step[0]:.4g} and {field.step[1]:.4g} {series.unit} apart: "
        f"{field.extent[0]:.4g} x {field.extent[1]:.4g} {series.unit}"
    )
    lost = field.lost
    worst = max(lost, key=lambda each: each.points)
    told = "no point in any frame"
    if worst.points:
        told = f"frame {worst.frame} most, {worst.points} of {rows * columns} points, {_where(worst)}"
        told += f"; in the first, {_where(lost[0])}" if lost[0].points else "; none in the first"
    return [
        (
            "frames",
            f"{len(numbers)} of {field.software} (format {field.dialect}), in {series.unit}, y {field.y_points}ward; "
            f"numbers {numbers[0]} to {numbers[-1]}{steps}{absent}",
        ),
        ("grid", "; ".join([grid, *field.notes])),
        ("lost", told),
    ]


def _where(lost: Lost) -> str:
    return f"{lost.outline} on the outline and {lost.inside} inside"


def _some(numbers: list, most: int = 8, count: int | None = None) -> str:
    """The first of them, and how many more there are of ``count``, or of those given."""
    count = len(numbers) if count is None else count
    return ", ".join(map(str, numbers[:most])) + (f" and {count - most} more" if count > most else "")


def _motion(seen: Inspection) -> str:
    H, source = mean_gradients(seen.kept), ""
    if not np.isfinite(H[1:]).any():
        H, source = seen.load.gradient[None], ", between the outermost lines that are measured"
    courses = {"along x": 1.0 + H[:, 0, 0], "along y": 1.0 + H[:, 1, 1], "in shear": H[:, 0, 1] + H[:, 1, 0]}
    known = {name: course[np.isfinite(course)] for name, course in courses.items() if np.isfinite(course).any()}
    told = [f"{_range(course, '.4f')} {name}" for name, course in known.items()]
    return f"mean stretch {', '.join(told)}{source}; most in frame {seen.load.frame}" if told else "not told"


def _load(seen: Inspection) -> str:
    return f"looks like {seen.load.kind}: {seen.load.reason}" if seen.load.kind else f"not told: {seen.load.reason}"


def _noise(seen: Inspection) -> str:
    noise = seen.sheet.cases[0].noise
    pixels = noise.scatter / seen.millimetres
    files = f"; {_range(pixels, '.2g')} pixel" if seen.field.series.unit == "pixel" else ""
    return f"{noise.source}{files}"


def _forces(seen: Inspection) -> list[tuple[str, str]]:
    rows = []
    for file in seen.files:
        name = f"{file.path.name}, of {file.program}"
        if file.refusal:
            rows.append(("forces", f"{name}, cannot be used"))
        elif file.cycles[0].cycle is None:
            rows.append(("forces", f"{name}: {_record(file.cycles[0].record)}"))
        else:
            rows += [("forces", f"{name}: {len(file.cycles)} cycles")] + [("", _cycle(each)) for each in file.cycles]
    if not seen.files and seen.others:
        names = _some([path.name for path in seen.others])
        rows.append(("forces", f"neither columns Time and Force nor those of a known program in {names}"))
    rows += [("", sentence)] if (sentence := _rate_alone(seen)) else []
    if seen.offsets:
        told = " and ".join(map(str, seen.offsets))
        rows.append(("", f"its clock is ahead of that of the frames by {told}"))
    return rows


def _rate_alone(seen: Inspection) -> str:
    """A sentence where a frame rate that was said is all that pairs frames and forces."""
    record, rate = seen.cycle and seen.cycle.record, seen.known.settings.get("frame_rate")
    if record is None or rate is None or record.image is not None or record.displacement is not None:
        return ""
    if record.time is None:
        return ""
    return (
        f"only frame_rate = {rate:g} pairs its forces with the frames: without a crosshead or a column of pictures, "
        "nothing here shows whether it is right"
    )


def _cycle(cycle: Cycle) -> str:
    return f"{cycle.set_name}, {cycle.cycle}: {_times(cycle.record)}, {_sizes(cycle.record)}"


def _record(record: ForceRecord) -> str:
    told = [f"{len(record.force)} samples", _times(record)]
    if record.image is not None and np.isfinite(record.image).any():
        told.append(f"pictures {_range(record.image[np.isfinite(record.image)], '.0f')}")
    told.append(_sizes(record))
    if record.displacement is not None:
        told.append(f"crosshead {_range(record.displacement)} mm")
    return ", ".join(filter(None, told)) + f" (columns {', '.join(record.channels)})"


def _times(record: ForceRecord) -> str:
    return "" if record.time is None else f"{record.time[0]:.4g} to {record.time[-1]:.4g} s"


def _sizes(record: ForceRecord) -> str:
    axes = ["force" if axis == PULL else f"force {axis}" for axis in record.axes]
    return ", ".join(f"{axis} {_range(force)} N" for axis, force in zip(axes, record.force.T, strict=True))


def _range(values: np.ndarray, form: str = ".4g") -> str:
    # Adding zero takes the sign away from it.
    return f"{values.min() + 0.0:{form}} to {values.max() + 0.0:{form}}"


def _import(seen: Inspection) -> list[tuple[str, str]]:
    if seen.sheet is None:
        return []
    case = seen.sheet.cases[0]
    steps = [f"frame {number} at {stretch:.3f}" for number, stretch in zip(case.numbers, case.stretch, strict=True)]
    for part, force in case.force.items():
        axis = f" along {'xy'[part[0]]}" if len(case.force) > 1 else ""
        steps = [f"{step}, {value:.3g} N{axis}" for step, value in zip(steps, force, strict=True)]
    rows = [("steps", "; ".join(steps))] + [("import", note) for note in seen.notes]
    return rows + ([("stiffness", _stiffness(seen))] if case.force else [])


def _stiffness(seen: Inspection) -> str:
    """The stiffness of the sheet as a whole, by which a reader sees a force in another unit."""
    settings, case = seen.known.settings, seen.sheet.cases[0]
    sections = [settings[side] * settings["thickness"] for side in ("height", "width")]
    pulled = case.stretch > 1.0
    secants = [(f / (sections[J] * (case.stretch - 1.0)))[pulled] for (_, J), f in case.force.items()]
    told = _range(np.concatenate(secants), ".2g")
    return f"force per section over stretch less one: {told} MPa; of known sheets, {_KNOWN}"
