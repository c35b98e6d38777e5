"""What limits the shape of the printed sheet: each hypothesis with its evidence from the test.

    python -m benchmarks.printed RESULTS MASK

RESULTS is a results folder with the printed family, which ``config/config.yaml`` makes from ``experiments/``. MASK is
the picture of the printed shape. Laws are those of the homogeneous sheets. Each hypothesis lays them out in another
way. The sheet is computed with its edges as measured, with no refit. What is missed of its displacements, over their
noise, says which one the test believes.
"""

import json
import sys
from dataclasses import KW_ONLY, dataclass, replace
from pathlib import Path

from hypernode.pipeline.compiler import set_up_compiler

set_up_compiler(float64=True)

import numpy as np
from PIL import Image
from scipy.ndimage import distance_transform_edt, shift, zoom

from hypernode.evaluation.shape import dice
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.prediction.laws import PhaseLaw, phase_laws
from hypernode.prediction.layout import Layout
from hypernode.prediction.predict import predict, problem_of
from hypernode.prediction.score import score
from hypernode.storage.netcdf import read
from hypernode.storage.schema import without_truth

METHOD = "hypernode"
SHEET, SOFT, STIFF = "stiff2_hetero", "soft_homo", "stiff2_homo"
#: Side of the sheet [mm].
SIDE = 40.0


@dataclass(frozen=True)
class Hypothesis:
    """One way in which the sheet may be.

    Attributes:
        what: in words.
        mask: 1 in the inclusion (row, column), the first row at the top.
        offsets: distances from its line, positive within, at which a further law begins [mm].
        stiffer: factor on the stiffness of the inclusion.
        window: side of the camera's window [mm].
    """

    what: str
    mask: np.ndarray
    _: KW_ONLY
    offsets: tuple[float, ...] = (0.0,)
    stiffer: float = 1.0
    window: float = 0.0

    def distances(self, X, corners) -> np.ndarray:
        """Distance of positions (point, 2) [mm] from every line (line, point) [mm]."""
        pixel = (corners[1, 0] - corners[0, 0]) / self.mask.shape[1]
        inside = (distance_transform_edt(self.mask) - distance_transform_edt(1 - self.mask)) * pixel
        size = np.array(self.mask.shape[::-1])
        place = (X - corners[0]) / (corners[1] - corners[0]) * size
        column, row = np.moveaxis(np.clip(place.astype(int), 0, size - 1), -1, 0)
        return np.array([inside[size[1] - 1 - row, column] - offset for offset in self.offsets])


def places(mask, side: float) -> list[Hypothesis]:
    """The sheet as printed, with the mask moved by up to 2.5 mm.

    Args:
        mask: 1 in the inclusion (row, column), of a sheet of a side [mm].
    """
    pixel = side / mask.shape[1]
    moves = [
        (0.0, 0.0),
        (0.5, 0.0),
        (-0.5, 0.0),
        (0.0, 0.5),
        (0.0, -0.5),
        (0.0, -1.0),
        (0.0, -1.5),
        (0.0, -2.0),
        (0.0, -2.5),
    ]
    return [
        Hypothesis(f"moved by {x:+.1f}, {y:+.1f} mm", shift(mask, (-y / pixel, x / pixel), order=0)) for x, y in moves
    ]


def hypotheses(mask) -> list[Hypothesis]:
    """One change each of a mask at its place."""
    found = [Hypothesis(f"{d:+.1f} mm wider all round", mask, offsets=(-d,)) for d in (-0.4, 0.4, 0.8)]
    found += [Hypothesis(f"graded over {w:.1f} mm", mask, offsets=(-w / 2, w / 2)) for w in (0.4, 1.0, 2.0)]
    found += [Hypothesis(f"seen through a window of {w:.1f} mm", mask, window=w) for w in (1.0, 1.9, 2.9)]
    found += [Hypothesis(f"scaled by {s:.2f}", _scaled(mask, s)) for s in (0.96, 1.04)]
    return found + [
        Hypothesis(f"inclusion {f:.1f} times as stiff as its own sheet", mask, stiffer=f) for f in (0.7, 0.8, 0.9, 1.1)
    ]


def _scaled(mask, factor: float):
    """The mask about its middle, in a frame of its own size."""
    grown, found = zoom(mask, factor, order=0), np.zeros_like(mask)
    more = [(g - m) // 2 for g, m in zip(grown.shape, mask.shape, strict=True)]
    inner = tuple(
        slice(max(d, 0), max(d, 0) + min(g, m)) for d, g, m in zip(more, grown.shape, mask.shape, strict=True)
    )
    place = tuple(
        slice(max(-d, 0), max(-d, 0) + min(g, m)) for d, g, m in zip(more, grown.shape, mask.shape, strict=True)
    )
    found[place] = grown[inner]
    return found


def of_sheet(results: Path, case: str) -> PhaseLaw:
    """The law of a homogeneous sheet: of the material with the median stiffness, where several were found."""
    path = results / case / METHOD / "constrained.nc"
    found = phase_laws(read(path), str(path))
    return found[len(found) // 2]


@dataclass(frozen=True)
class Mixture:
    """Both laws side by side: their stresses by a share of the stiff one."""

    soft: ConvexBasis
    stiff: ConvexBasis
    share: float

    @property
    def names(self) -> tuple[str, ...]:
        """Those of both."""
        return *self.soft.names, *self.stiff.names

    @property
    def start(self) -> np.ndarray:
        """Plain materials."""
        return np.concatenate([self.soft.start, self.stiff.start])

    def stress(self, F, params):
        """First Piola-Kirchhoff stress P[i, J, ...]."""
        own = len(self.soft.names)
        of_soft, of_stiff = self.soft.stress(F, params[:own]), self.stiff.stress(F, params[own:])
        return (1.0 - self.share) * of_soft + self.share * of_stiff


def mixed(soft: PhaseLaw, stiff: PhaseLaw, share: float) -> PhaseLaw:
    """The law of a mixture, without samples."""
    best = np.concatenate([soft.best, stiff.best])
    return replace(stiff, basis=Mixture(soft.basis, stiff.basis, share), best=best, samples=np.zeros((0, len(best))))


@dataclass(frozen=True, kw_only=True)
class Row:
    """What a hypothesis leaves.

    Attributes:
        what: in words.
        missed: displacements, over their noise.
        off: the same over their size.
        force: missed.
        dice: of a field that is exactly so with the mask as printed; None of a sheet without an inclusion.
    """

    what: str
    missed: float
    off: float
    force: float
    dice: float | None


def tried(what: str, measurement, laws: list[PhaseLaw], distances, printed=None) -> Row:
    """One equilibrium with its edges as measured, against the test.

    Args:
        laws: one after the other, from outside in.
        distances: of the lines between them, from positions (point, 2) and corners [mm]; None of one law.
        printed: distances of the mask as printed.
    """
    problem = problem_of(measurement, [[law] for law in laws])
    mesh, corners = problem.observations.grid, np.array(json.loads(measurement.attrs["field_corners"]))
    lines = np.zeros((0, len(mesh.nodes)))
    if distances is not None:
        lines = distances(mesh.nodes, corners) / np.median(np.diff(mesh.lines[0]))
    found = predict(measurement, problem, [[law] for law in laws], Layout(np.arange(len(laws)), lines), what)
    scored, shape = score(measurement, found), None
    if printed is not None:
        shape = dice(distances(mesh.centres, corners).mean(axis=0) > 0, printed(mesh.centres, corners)[0] > 0)
    off = scored.displacement_error[-1]
    return Row(what=what, missed=off / scored.displacement_noise[-1], off=off, force=scored.force_error[-1], dice=shape)


def of_hypothesis(each: Hypothesis, measurement, soft: PhaseLaw, stiff: PhaseLaw, printed) -> Row:
    """The row of a hypothesis."""
    best = stiff.best.copy()
    best[0] += np.log(each.stiffer)
    stiff, between = replace(stiff, best=best), len(each.offsets)
    laws = [soft, *(mixed(soft, stiff, k / between) for k in range(1, between)), stiff]
    seen = measurement.assign_attrs(correlation_window=each.window)
    return tried(each.what, seen, laws, each.distances, printed.distances)


def last_step(results: Path, case: str):
    """The measurement of a sheet at its largest load: one step tells a shape."""
    return without_truth(read(results / case / "measurement.nc")).isel(load_step=[-1])


def main(results: Path, mask_file: Path) -> None:
    """Print what homogeneous sheets leave under their own law, then a row for each hypothesis, the likeliest first."""
    laws = {case: of_sheet(results, case) for case in (SOFT, STIFF)}
    rows = [tried(f"{case} by its own law", last_step(results, case), [law], None) for case, law in laws.items()]
    measurement = last_step(results, SHEET)
    mask = (np.asarray(Image.open(mask_file).convert("L")) > 127).astype(float)[::-1]
    printed = Hypothesis("", mask)

    def row(each: Hypothesis) -> Row:
        return of_hypothesis(each, measurement, laws[SOFT], laws[STIFF], printed)

    moved = {each.what: (row(each), each) for each in places(mask, SIDE)}
    _, best = min(moved.values(), key=lambda pair: pair[0].missed)
    changed = [replace(row(each), what=f"{best.what}, {each.what}") for each in hypotheses(best.mask)]
    print(
        "| the sheet is | displacements missed, of their noise | of their size | forces missed | Dice of such a field |"
    )
    print("|---|---|---|---|---|")
    for each in [*rows, *sorted([pair[0] for pair in moved.values()] + changed, key=lambda one: one.missed)]:
        shape = "-" if each.dice is None else f"{each.dice:.2f}"
        print(f"| {each.what} | {each.missed:.1f} | {each.off:.2%} | {each.force:.1%} | {shape} |")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
