"""Folders of small tests, written as a laboratory exports them: analytic fields with noise, in pixels."""

import json

import numpy as np

#: Points along x and y, their distance in pixels, and the length of a pixel [mm].
COLUMNS, ROWS, STEP, PIXEL = 13, 12, 20, 0.05
#: Width, height and thickness of the sheet [mm], which the field covers.
SIZE = ((COLUMNS - 1) * STEP * PIXEL, (ROWS - 1) * STEP * PIXEL, 1.0)
GIVEN = {**dict(zip(("width", "height", "thickness"), SIZE, strict=True)), "frame_rate": 1.0}
#: Standard deviation of a displacement [pixel].
NOISE = 0.02
HEADER = "x [pixel];y [pixel];x-displacement [pixel];y-displacement [pixel]"


def clamped(along, across, t):
    """(displacement along the pull, across it), over the sides of the sheet, where both ends are held across."""
    return t * along, -0.4 * t * (across - 0.5) * 4.0 * along * (1.0 - along)


def free(along, across, t):
    return t * along, -0.45 * t * (across - 0.5)


def one_end(along, across, t):
    return t * along, -0.45 * t * (across - 0.5) * along


#: Load -> displacement (x, y) over the sides of the sheet at places (x, y) of the unit square and a size t.
FIELDS = {
    "clamped_y": lambda x, y, t: clamped(y, x, t)[::-1],
    "clamped_x": clamped,
    "uniaxial_y": lambda x, y, t: free(y, x, t)[::-1],
    "uniaxial_x": free,
    "biaxial": lambda x, y, t: (t * x, 0.6 * t * y),
    "biaxial_clamped": lambda x, y, t: (t * (x - 0.5) * 4 * y * (1 - y), t * (y - 0.5) * 4 * x * (1 - x)),
    "shear": lambda x, y, t: (t * y, 0.0 * y),
    "general": lambda x, y, t: (t * y, t * y),
}


def write_frames(folder, field, sizes=(0.0, 0.04, 0.08, 0.12), first=1, change=lambda number, rows: rows, noise=NOISE):
    """Frames of a field in DaVis' pixels, y downward; the first is the reference, without noise."""
    rng = np.random.default_rng(3)
    folder.mkdir(exist_ok=True)
    for number, t in enumerate(sizes, start=first):
        rows = []
        for j in range(ROWS):
            for i in range(COLUMNS):
                u, v = field(i / (COLUMNS - 1), (ROWS - 1 - j) / (ROWS - 1), t)
                scatter = rng.normal(0.0, noise, 2) * (t > 0.0)
                u, v = u * (COLUMNS - 1) * STEP + scatter[0], v * (ROWS - 1) * STEP + scatter[1]
                rows.append(f"{5 + STEP * i};{10 + STEP * j};{u:.9g};{-v:.9g}")
        (folder / f"Pull{number:04d}.csv").write_text("\n".join([HEADER, *change(number, rows)]) + "\n")
    return folder


def write_record(folder, name="force_disp.csv", sizes=(0.0, 0.04, 0.08, 0.12), axes=("",), change=lambda f: f):
    """A record in which every frame has its second, with one force or one along each axis."""
    time = np.linspace(0.0, len(sizes) - 1.0, 61)
    stretch = 1.0 + np.interp(time, np.arange(len(sizes)), sizes)
    force = change(30.0 * (stretch - stretch**-2.0))
    names = ["Time", *(f"Force{axis}" for axis in axes)]
    units = ["(s)", *("(N)" for _ in axes)]
    rows = [",".join(f"{each:.9g}" for each in (t, *[f] * len(axes))) for t, f in zip(time, force, strict=True)]
    (folder / name).write_text("\n".join([",".join(names), ",".join(units), *rows]) + "\n")


def strict(text):
    """What strict JSON says; NaN and Infinity are none."""

    def refuse(constant):
        raise ValueError(f"{constant} is no JSON")

    return json.loads(text, parse_constant=refuse)
