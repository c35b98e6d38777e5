"""The files of a test, as a laboratory would bring them, and the truth, which no laboratory has."""

from pathlib import Path

import numpy as np
import yaml
from scipy.interpolate import CubicSpline
from scipy.ndimage import convolve1d

from benchmarks.strangers.design import SIDE, THICKNESS, Sheet
from benchmarks.strangers.laws import stress
from benchmarks.strangers.solve import Equilibria

#: Parts of a step between points in which a window is averaged.
PARTS = 4
#: Pictures of a test, pictures and rows of the record in a second.
FRAMES, RATE, ROWS = 25, 5.0, 20.0
#: Fixed-point passes to where a point of the first picture lies at rest: each leaves a preload's share of the error.
PASSES = 5
#: Shares of the largest strain at which laws are compared in :data:`MODES`.
PROBED = (0.4, 0.8)
#: Deformations that all points of a sheet undergo, by their stretch.
MODES = {
    "equibiaxial": lambda s: [[s, 0.0], [0.0, s]],
    "along x": lambda s: [[s, 0.0], [0.0, s**-0.5]],
    "along y": lambda s: [[s**-0.5, 0.0], [0.0, s]],
    "shear": lambda s: [[1.0, s - 1.0], [0.0, 1.0]],
}


def _window(sheet: Sheet) -> np.ndarray:
    """Weights of the parts of a window along one axis, by the trapezoidal rule."""
    half = round(sheet.window * PARTS / 2)
    weights = np.ones(2 * half + 1)
    if half:
        weights[[0, -1]] = 0.5
    return weights / weights.sum()


def _through(sheet: Sheet, fine):
    """What the points that are kept show of fields (..., row, column, component) on the parts of steps."""
    for axis in (-3, -2):
        fine = convolve1d(fine, _window(sheet), axis=axis, mode="nearest")
    return fine[..., ::PARTS, ::PARTS, :][..., sheet.kept, sheet.kept, :]


def _grid(ticks) -> np.ndarray:
    return np.stack(np.meshgrid(ticks, ticks), axis=-1)


def write_test(sheet: Sheet, equilibria: Equilibria, folder: Path) -> None:
    """Frames, record and the specimen's configuration, in ``folder/test`` and ``folder/sheet.yaml``."""
    rng = np.random.default_rng([sheet.seed, 2])
    test = folder / "test"
    test.mkdir(parents=True, exist_ok=True)
    fine = _grid(np.linspace(0.0, SIDE, PARTS * (sheet.points - 1) + 1))
    first = sheet.preload / sheet.top
    course = CubicSpline(*_from_rest(equilibria.amount, _through(sheet, _moved(equilibria, fine, first))))
    reference = course(first)
    pixel = sheet.step / sheet.step_pixels
    share = (_window(sheet) ** 2).sum()
    for frame in range(FRAMES):
        shown = (course(first + (1.0 - first) * frame / (FRAMES - 1)) - reference) / pixel
        if frame:
            # Subsets that overlap share the pixels from which their errors are.
            shown = shown + sheet.noise / share * _through(sheet, rng.normal(size=fine.shape))
        _write_frame(sheet, shown, test / f"sheet_{frame + 1:03d}.csv")
    _write_record(sheet, equilibria, rng, test / "force_disp.csv")
    specimen = {
        "folder": "test",
        "load": sheet.load,
        "width": SIDE,
        "height": SIDE,
        "thickness": THICKNESS,
        "pixel_size": pixel,
        "frame_rate": RATE,
        "outline": "edge" if sheet.load == "biaxial" and sheet.kept.start == 0 else "cut",
        "edge_ring": 0,
    }
    (folder / "sheet.yaml").write_text(yaml.safe_dump({"specimens": {"sheet": specimen}}, sort_keys=False))


def _from_rest(amount, values):
    """(amounts, values) of loads with that at rest, which is zero."""
    return np.r_[0.0, amount], np.concatenate([0.0 * values[:1], values])


def _moved(equilibria: Equilibria, shown, first: float) -> np.ndarray:
    """Displacement from rest (load, row, column, 2) of what lies at positions of the first picture.

    Args:
        shown: positions (row, column, 2) [mm].
        first: share of the largest load that the first picture has.
    """
    rest = shown
    for _ in range(PASSES if first else 1):
        u = equilibria.displacement(rest.reshape(-1, 2)).reshape(-1, *shown.shape)
        rest = shown - CubicSpline(*_from_rest(equilibria.amount, u))(first)
    return u


def _write_frame(sheet: Sheet, shown, file: Path) -> None:
    """One frame in pixels, y downward, row by row from the top."""
    count = len(shown)
    rows = ["x [pixel];y [pixel];x-displacement [pixel];y-displacement [pixel]"]
    for row, line in enumerate(shown[::-1]):
        y = 40.0 + row * sheet.step_pixels
        rows += [f"{60.0 + k * sheet.step_pixels:.2f};{y:.2f};{line[k, 0]:.5f};{-line[k, 1]:.5f}" for k in range(count)]
    file.write_text("\n".join(rows) + "\n")


def _write_record(sheet: Sheet, equilibria: Equilibria, rng, file: Path) -> None:
    """Time and force along the axes that pull."""
    axes = (0, 1) if sheet.load == "biaxial" else (1,)
    names, units = (["Force x", "Force y"], ["(N)", "(N)"]) if len(axes) == 2 else (["Force"], ["(N)"])
    force = THICKNESS * equilibria.force[:, axes]
    course, first = CubicSpline(*_from_rest(equilibria.amount, force)), sheet.preload / sheet.top
    time = np.arange(0.0, (FRAMES - 1) / RATE + 0.1, 1.0 / ROWS)
    errors = sheet.force_zero + sheet.force_scatter * rng.normal(size=(len(time), len(axes)))
    pulled = np.maximum(time * RATE - sheet.late, 0.0) / (FRAMES - 1)
    measured = (1.0 + sheet.force_gain) * course(first + (1.0 - first) * pulled) + errors * force[-1]
    rows = [",".join(f"{value:.6f}" for value in (t, *each)) for t, each in zip(time, measured, strict=True)]
    file.write_text("\n".join([",".join(["Time", *names]), ",".join(["(s)", *units]), *rows]) + "\n")


def write_truth(sheet: Sheet, equilibria: Equilibria, file: Path) -> None:
    """True stress [MPa] in the cells of the measured grid, the outermost left out in :data:`MODES`.

    Writes ``X`` (cell, 2) [mm from the lower left point that is seen], ``whole`` (cell,), ``inner`` (cell,), ``F`` and
    ``P`` (load, cell, 2, 2) at the deformation of the test, ``mode_F`` and ``mode_P`` (mode, stretch, cell, 2, 2).
    """
    ticks = np.linspace(0.0, SIDE, sheet.points)[sheet.kept]
    nodes = _grid(ticks)
    chosen = [len(equilibria.amount) // 2 - 1, -1]
    u = equilibria.displacement(nodes.reshape(-1, 2))[chosen].reshape(2, *nodes.shape)
    low_low, low_high, high_low, high_high = u[:, :-1, :-1], u[:, :-1, 1:], u[:, 1:, :-1], u[:, 1:, 1:]
    along_x, along_y = low_high + high_high - low_low - high_low, high_low + high_high - low_low - low_high
    F = np.eye(2) + np.stack([along_x, along_y], axis=-1).reshape(2, -1, 2, 2) / (2.0 * sheet.step)
    middle = (ticks[1:] + ticks[:-1]) / 2
    centres = _grid(middle).reshape(-1, 2)
    inner = np.zeros((len(middle),) * 2, bool)
    inner[1:-1, 1:-1] = True
    stretches = 1.0 + sheet.top * np.array(PROBED)
    modes = np.array([[mode(s) for s in stretches] for mode in MODES.values()])
    mode_F = np.broadcast_to(modes[:, :, None], (*modes.shape[:2], len(centres), 2, 2))
    weights, shares = sheet.weights(centres), equilibria.amount[chosen]
    np.savez(
        file,
        X=centres - ticks[0],
        whole=sheet.whole(centres, sheet.step / 2),
        inner=inner.ravel(),
        F=F,
        P=np.concatenate(
            [stress(sheet.kind, sheet.laws_at(a), f[None], weights) for a, f in zip(shares, F, strict=True)]
        ),
        mode_F=mode_F,
        mode_P=stress(sheet.kind, sheet.laws_at(0.0), mode_F, weights),
    )
