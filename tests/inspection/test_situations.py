"""Situations that people report of neighbouring software: each is imported right, or refused with the way out.

One sheet of 12 x 12 mm, pulled by a fiftieth of its height a second, in files that the table writes itself.
"""

import re
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass, field
from itertools import pairwise

import numpy as np
import pytest

from hypernode.inspection.folder import inspect
from tests.dic.pulls import HEADER, NOISE, STEP, fields, write

SIZE = {"width": 12.0, "height": 12.0, "thickness": 1.0}
TIME = np.round(np.arange(0.0, 8.05, 0.1), 9)
BLOCK = np.s_[7:11, 4:9]


def force_at(elongation):
    stretch = 1.0 + np.asarray(elongation)
    return 3.0 * (stretch - stretch**-3.0)


def record(
    folder,
    header="Time (s),Displacement (mm),Force (N)",
    row=lambda t, way, f: f"{t:.4f},{way:.5f},{f:.6f}",
    time=TIME,
    elongation=lambda t: STEP * t,
    force=force_at,
    name="force_disp.csv",
):
    elongations = [elongation(t) for t in time]
    rows = [row(t, 12.0 * e, float(force(e))) for t, e in zip(time, elongations, strict=True)]
    (folder / name).write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")


@dataclass(frozen=True)
class Situation:
    """Files, and what must come of them.

    Attributes:
        make: writes them.
        given: what is known of the test.
        said: what the inspection says, empty for nothing.
        answer: keys that answer a refusal; None where nothing is refused, empty where no key can answer it.
        elongation: of a frame, by its number.
        lost: points that are lost in the load steps, at most.
        sentences: how many it says.
    """

    make: Callable
    _: KW_ONLY
    given: dict = field(default_factory=lambda: {"frame_rate": 1.0})
    said: str = ""
    answer: dict | None = None
    elongation: Callable = lambda number: STEP * number
    lost: int = 0
    sentences: int = 1


def at(places, value=np.nan, steps=range(1, 9), frames=None):
    frames = fields() if frames is None else frames
    for k in steps:
        frames[k][places] = value
    return frames


def control(folder, frames=None, **more):
    write(folder, fields() if frames is None else frames, **more)
    record(folder)


def of_record(**more):
    def make(folder):
        write(folder, fields())
        record(folder, **more)

    return make


def lost_at_random(folder):
    rng = np.random.default_rng(1)
    control(
        folder, [u if k == 0 else np.where(rng.random((13, 13, 1)) < 0.03, np.nan, u) for k, u in enumerate(fields())]
    )


def folder_a_step(folder):
    for k, u in enumerate(fields()[1:5], start=1):
        write(folder / str(10 * k), [u], names=["output_nodes.csv"])


def failed(folder):
    frames = at(BLOCK, 0.3, (3, 5))
    more = lambda k, u: [np.where((u[..., 0] == 0.3), -4.0, 0.98)]  # noqa: E731
    control(folder, frames, header=HEADER + ",zncc", more=more)


def increments(folder):
    frames = fields()
    write(folder, [frames[0], *(b - a for a, b in pairwise(frames))])
    record(folder, "Time (s),Force (N)", lambda t, way, f: f"{t:.4f},{f:.6f}")


def frozen(folder):
    frames = fields()
    control(folder, at(BLOCK, frames[4][BLOCK], (5, 6, 7), frames))


def repeated(folder):
    frames = fields()
    control(folder, [*frames[:4], frames[3], *frames[4:8]])


IRREGULAR = (0.0, 0.5, 1.7, 2.1, 4.6, 5.0, 6.9, 7.2, 8.0)


def irregular(folder):
    write(folder, fields(steps=STEP * np.array(IRREGULAR[1:])))
    taken = {round(10 * t): k for k, t in enumerate(IRREGULAR)}
    row = lambda t, way, f: f"{t:.4f},{f:.6f},{taken.get(round(10 * t), '')}"  # noqa: E731
    record(folder, "Time (s),Force (N),Image", row)


def counted_from_one(folder):
    write(folder, fields())
    row = lambda t, way, f: f"Image_{t + 1:04.0f}_0.tiff;{t:.3f};{f:.6f}"  # noqa: E731
    record(folder, "File;TimeStamp;Force [N]", row, time=TIME[::10])


CYCLES = np.array([0, 2, 4, 6, 4, 2, 0, 2, 4, 6])


def two_cycles(folder):
    write(folder, fields(steps=STEP * CYCLES[1:]))
    record(folder, time=np.linspace(0.0, 9.0, 91), elongation=lambda t: STEP * np.interp(t, np.arange(10), CYCLES))


def with_hole(missing):
    return lambda folder: control(folder, keep=lambda x, y: ~missing(x, y))


def clocked(t):
    return f"{(23 + (t >= 3)) % 24:02d}:{(59 + (t >= 3)) % 60:02d}:{(57 + t) % 60:05.2f}"


TENTH = [np.array([0.1, 0.1]) * u for u in fields()]
WAVE = '"Gesamtzeit (s)";"Gesamtzyklen";"Position des Aktuators(X:Position) (mm)";"Last(X:Kraft) (kN)";'
TABLE = {"x": "x [mm]", "y": "y [mm]", "u": "u [mm]", "v": "v [mm]", "deformed": True}
SITUATIONS = {
    "nothing is wrong": Situation(control),
    "points lost at random": Situation(lost_at_random, lost=10),
    "positions move with the sheet": Situation(
        lambda folder: control(folder, deformed=True), said="deformed: true", answer={"format": "table", "table": TABLE}
    ),
    "a folder a load step": Situation(folder_a_step, said="look like the steps of one test", answer={}),
    "a hole in a corner": Situation(with_hole(lambda x, y: np.hypot(x, y) < 4.5), said="declare it, hole", lost=17),
    "points marked as failed": Situation(failed, lost=20),
    "displacements from frame to frame": Situation(
        increments, said="--set increments=true", answer={"increments": True}
    ),
    "a block that stands still": Situation(frozen, said="60 displacements in 3 frames", lost=20),
    "a camera that repeated a picture": Situation(
        repeated, said="4 .as 3.", elongation=lambda number: STEP * (number - (number > 3))
    ),
    "newest first": Situation(
        lambda folder: control(folder, fields()[::-1]), said="newest_first=true", answer={"newest_first": True}
    ),
    "names that are clock times": Situation(
        lambda folder: control(
            folder,
            names=[f"cam_20230504_1011{56 + k:02d}.csv" for k in range(4)]
            + [f"cam_20230504_1012{k:02d}.csv" for k in range(5)],
        ),
        given={},
    ),
    "a German record": Situation(
        of_record(header=WAVE, row=lambda t, way, f: f"{t:.2f};1;{way - 24.64:.6f};{f / 1e3:.9f};".replace(".", ","))
    ),
    "a load cell at its limit": Situation(
        of_record(force=lambda e: min(force_at(e), 1.3)), said="the load cell is at its limit"
    ),
    "a zero that is none": Situation(
        of_record(force=lambda e: force_at(e) + 0.1), said="--set force_offset=0.1", answer={"force_offset": 0.1}
    ),
    "pictures at irregular times": Situation(
        irregular, given={}, elongation=lambda number: STEP * np.array(IRREGULAR)[number]
    ),
    "pictures counted from one": Situation(counted_from_one, said="picture_shift=1"),
    "a gap in the record": Situation(
        of_record(time=TIME[(TIME <= 3.0) | (TIME >= 6.0)]), said="no sample from 3 to 6 s"
    ),
    "displacements a tenth of the true ones": Situation(
        lambda folder: control(folder, TENTH), said=r"the crosshead moves by .* \(10\)", answer={}
    ),
    "a table of CellScale": Situation(
        of_record(
            header="SetName,Cycle,Time_S,Size_mm,Displacement_mm,Force_N",
            row=lambda t, way, f: f"Ramp,1-Stretch,{t:.2f},12,{way:.5f},{f:.6f}",
        )
    ),
    "two cycles": Situation(two_cycles, said="pulled 2 times", elongation=lambda number: STEP * CYCLES[number]),
    "notches at the edges": Situation(
        with_hole(lambda x, y: (np.abs(y - 6.0) < 0.5) & (np.abs(x - 6.0) > 2.5)),
        said="declare it, hole",
        lost=8,
        sentences=2,
    ),
    "clock times in the record": Situation(of_record(row=lambda t, way, f: f"{clocked(t)},{way:.5f},{f:.6f}")),
}


def said_of(found):
    return "\n".join(each.sentence for each in (*found.known.odd, *found.known.missing))


@pytest.mark.parametrize("name", SITUATIONS)
def test_a_situation_ends_right_or_is_refused_with_the_way_out(name, tmp_path):
    one, folder = SITUATIONS[name], tmp_path / "pull"
    folder.mkdir()
    one.make(folder)
    found = inspect(folder, {**SIZE, **one.given})
    if one.said:
        assert re.search(one.said, said_of(found)), said_of(found)
    assert len(found.known.odd + found.known.missing) == (one.sentences if one.said else 0), said_of(found)
    assert (found.sheet is None) == (one.answer is not None), said_of(found)
    if one.answer:
        found = inspect(folder, {**SIZE, **one.given, **one.answer})
    if one.answer != {}:
        case = found.sheet.cases[0]
        elongation = one.elongation(case.numbers)
        np.testing.assert_allclose(case.force[1, 1], force_at(elongation), rtol=2e-3)
        np.testing.assert_allclose(case.stretch, 1.0 + elongation, atol=1e-3)
        assert np.sqrt(np.mean(case.noise.scatter**2)) == pytest.approx(NOISE, rel=0.2)
        assert np.isnan(found.sheet.u).any(axis=2).sum(axis=1).max() <= one.lost
