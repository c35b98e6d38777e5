"""Folders of a clamped pull in mm, written with the faults that people report."""

import numpy as np

#: Lines of the grid [mm], noise [mm] and stretch of the sheet in one step.
LINES, NOISE, STEP = np.linspace(0.0, 12.0, 13), 0.004, 0.02
HEADER = "x [mm],y [mm],u [mm],v [mm]"


def fields(count=8, seed=5, steps=None):
    """Displacement (row, column, 2) of the reference and of deformed frames, with noise."""
    rng = np.random.default_rng(seed)
    y, x = np.meshgrid(LINES, LINES, indexing="ij")
    found = [np.zeros((*x.shape, 2))]
    for t in steps if steps is not None else STEP * np.arange(1, count + 1):
        bulge = 4.0 * (y / 12.0) * (1.0 - y / 12.0)
        u = np.stack([-0.4 * t * (x - 6.0) * bulge, t * y], axis=-1)
        found.append(u + rng.normal(0.0, NOISE, u.shape))
    return found


def write(folder, frames, names=None, header=HEADER, more=None, deformed=False, keep=None):
    """One table a frame; ``more`` gives further cells of a frame, ``keep`` which points it has."""
    folder.mkdir(parents=True, exist_ok=True)
    y, x = np.meshgrid(LINES, LINES, indexing="ij")
    for k, u in enumerate(frames):
        moved = u if deformed else np.zeros_like(u)
        cells = [x + moved[..., 0], y + moved[..., 1], u[..., 0], u[..., 1], *(more(k, u) if more else ())]
        kept = np.ones(x.shape, dtype=bool) if keep is None else keep(x, y)
        rows = zip(*(np.broadcast_to(each, x.shape)[kept] for each in cells), strict=True)
        lines = [",".join(each if isinstance(each, str) else f"{each:.6f}" for each in row) for row in rows]
        name = names[k] if names else f"frame{k:04d}.csv"
        (folder / name).write_text("\n".join([header, *lines]) + "\n")
    return folder


def write_record(folder, count=8, times=None):
    """A record with a sample in each tenth of a second, whose force grows by 0.5 N in each."""
    time = np.round(np.arange(0.0, count + 0.05, 0.1), 9)
    said = [f"{t:g}" for t in time] if times is None else [times(t) for t in time]
    rows = [f"{t},{0.5 * seconds:.6f}" for t, seconds in zip(said, time, strict=True)]
    (folder / "force_disp.csv").write_text("\n".join(["Time,Force", "(s),(N)", *rows]) + "\n")
    return folder
