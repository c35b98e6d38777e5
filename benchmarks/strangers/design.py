"""What a seed stands for: the shape, laws and load of a sheet, and the camera and the load cell that see it."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from benchmarks.strangers.laws import LAWS

#: Side and thickness of every sheet [mm].
SIDE, THICKNESS = 30.0, 1.5
#: Shear modulus of the first law [MPa].
MODULUS = 0.4
#: Bounds between which numbers are drawn; a contrast acts either way.
CONTRAST, TOP, NOISE = (1.15, 6.0), (0.1, 0.3), (0.008, 0.06)
#: Shape -> how often it comes.
SHAPES = {"islands": 0.35, "strokes": 0.2, "discs": 0.25, "slope": 0.1, "none": 0.1}
#: Radius of the disc and width of the stripe that no seed draws, over the side.
DISC, STRIPE = 0.2, 0.2


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """One sheet and its test.

    Attributes:
        shape, kind, load: key of :data:`SHAPES`, of ``LAWS``, and ``clamped_y`` or ``biaxial``.
        laws: parameter -> its value in every law (law,).
        top: largest mean strain along y; ``across`` times that along x, of a biaxial load.
        points: of the camera's grid along a side of the whole sheet.
        seen: share of each side that the camera sees.
        window: side of the averaging window of the correlation, in steps of the grid.
        noise: standard deviation of a displacement [pixel].
        step_pixels: pixels from one point to the next.
        force_scatter, force_zero: scatter and zero of the load cell, over the last force.
        force_gain: its relative error that all forces share.
        preload: mean strain along y that the sheet has in the first picture.
        late: frames by which the clock of the record is late.
        fades: share of its stiffness that the last law loses in the course of the test.
        grows: share of its size by which the last law grows in its course.
        thins: relative thickness at the right side less that at the left.
    """

    seed: int
    shape: str
    kind: str
    load: str
    laws: dict[str, np.ndarray] = field(repr=False)
    top: float
    across: float
    points: int
    seen: float
    window: float
    noise: float
    step_pixels: float
    force_scatter: float
    force_gain: float
    force_zero: float
    preload: float = 0.0
    late: float = 0.0
    fades: float = 0.0
    grows: float = 0.0
    thins: float = 0.0

    def laws_at(self, amount: float) -> dict[str, np.ndarray]:
        """Parameters of the laws at a share of the largest load, which stands for a time."""
        changed = dict(self.laws)
        if self.fades:
            changed["mu"] = changed["mu"] * np.r_[np.ones(self.phases - 1), 1.0 - self.fades * amount]
        if self.grows:
            changed["grown"] = np.r_[np.ones(self.phases - 1), 1.0 + self.grows * amount]
        return changed

    def relative_thickness(self, X) -> np.ndarray:
        """Over the mean one (point, 1), at positions [mm] (point, 2)."""
        return 1.0 + self.thins * (np.asarray(X)[:, :1] / SIDE - 0.5)

    @property
    def phases(self) -> int:
        """Number of laws."""
        return len(self.laws["mu"])

    @property
    def step(self) -> float:
        """From one point of the grid to the next [mm]."""
        return SIDE / (self.points - 1)

    @property
    def kept(self) -> slice:
        """Points along a side whose window lies within the sheet and which the camera sees."""
        outside = round((1.0 - self.seen) / 2 * (self.points - 1))
        lost = max(int(np.ceil(self.window / 2)), outside)
        return slice(lost, self.points - lost)

    @cached_property
    def _shape(self):
        """(position in the unit square (point, 2)) -> weights of the laws."""
        return _DRAWN[self.shape](np.random.default_rng([self.seed, 1]), self.phases)

    def weights(self, X) -> np.ndarray:
        """Share of every law (point, law) at positions [mm] (point, 2)."""
        found = self._shape(np.asarray(X) / SIDE)
        return found if found.ndim == 2 else np.eye(self.phases)[found]

    def whole(self, X, half: float) -> np.ndarray:
        """Whether a square of a half side [mm] about positions (point, 2) has one law, or laws that mix smoothly."""
        at = np.linspace(-half, half, 11)
        square = np.stack(np.meshgrid(at, at), axis=-1).reshape(-1, 1, 2)
        if self.shape == "slope":
            return np.ones(len(X), bool)
        around = self._shape(((np.asarray(X) + square) / SIDE).reshape(-1, 2)).reshape(len(square), -1)
        return (around == around[0]).all(axis=0)


def design(seed: int) -> Sheet:
    """The sheet of a seed."""
    rng = np.random.default_rng([seed, 0])
    shape = str(rng.choice(list(SHAPES), p=list(SHAPES.values())))
    several = int(rng.choice([2, 3], p=[0.75, 0.25]))
    phases = {"none": 1, "slope": 2}.get(shape, several)
    kind = str(rng.choice(list(LAWS)))
    contrast = np.exp(rng.uniform(*np.log(CONTRAST), 2) * rng.choice([-1, 1], 2))
    laws = {"mu": MODULUS * np.r_[1.0, contrast][:phases]}
    laws |= {name: rng.uniform(*bounds, 3)[:phases] for name, bounds in LAWS[kind][1].items()}
    load = str(rng.choice(["clamped_y", "biaxial"]))
    seen = float(rng.choice([1.0, 0.75], p=[2 / 3, 1 / 3]))
    return Sheet(
        seed=seed,
        shape=shape,
        kind=kind,
        load=load,
        laws=laws,
        top=float(rng.uniform(*TOP)),
        across=float(rng.uniform(0.7, 1.0)),
        points=int(rng.integers(36, 57)),
        seen=seen if load == "clamped_y" else 1.0,
        window=float(rng.choice([0.0, 1.5, 2.5])),
        noise=float(np.exp(rng.uniform(*np.log(NOISE)))),
        step_pixels=float(rng.integers(14, 25)),
        force_scatter=0.002,
        force_gain=float(rng.normal(0.0, 0.005)),
        force_zero=float(rng.normal(0.0, 0.001)),
    )


def _nowhere(rng, phases):
    return lambda x: np.zeros(len(x), int)


def _islands(rng, phases):
    """Where a sum of smooth bumps is largest, and where it is smallest; each on a stated share of the sheet."""
    centres, heights = rng.uniform(-0.1, 1.1, (40, 2)), rng.normal(size=40)
    width, shares = rng.uniform(0.09, 0.16), rng.uniform(0.12, 0.3, 2)

    def bumps(x):
        return sum(
            h * np.exp(-((x - c) ** 2).sum(axis=1) / (2 * width**2)) for c, h in zip(centres, heights, strict=True)
        )

    at = (np.arange(60) + 0.5) / 60
    everywhere = bumps(np.stack(np.meshgrid(at, at), axis=-1).reshape(-1, 2))
    high, low = np.quantile(everywhere, [1.0 - shares[0], shares[1]])

    def label(x):
        value = bumps(x)
        return np.where(value > high, 1, np.where((value < low) & (phases > 2), 2, 0))

    return label


def _strokes(rng, phases):
    """A bent stroke of a pen for each further law."""
    t = np.linspace(0.0, 1.0, 33)[:, None]
    curves = []
    for _ in range(phases - 1):
        a, b, c = rng.uniform(0.15, 0.85, (3, 2))
        curves.append(((1 - t) ** 2 * a + 2 * t * (1 - t) * b + t**2 * c, rng.uniform(0.04, 0.08)))

    def label(x):
        found = np.zeros(len(x), int)
        for k, (points, half) in enumerate(curves, start=1):
            for begin, along in zip(points[:-1], np.diff(points, axis=0), strict=True):
                share = np.clip((x - begin) @ along / (along @ along), 0.0, 1.0)
                found[((x - begin - share[:, None] * along) ** 2).sum(axis=1) < half**2] = k
        return found

    return label


def _discs(rng, phases):
    """One to three discs for each further law."""
    owner = np.repeat(np.arange(1, phases), rng.integers(1, 4, phases - 1))
    centres, radii = rng.uniform(0.2, 0.8, (len(owner), 2)), rng.uniform(0.08, 0.2, len(owner))

    def label(x):
        inside = ((x[:, None] - centres) ** 2).sum(axis=2) < radii**2
        return (inside * owner).max(axis=1)

    return label


def _slope(rng, phases):
    """From the first law to the second along a direction."""
    angle, width = rng.uniform(0.0, 2 * np.pi), rng.uniform(0.08, 0.2)
    along = np.array([np.cos(angle), np.sin(angle)])

    def share(x):
        second = 1.0 / (1.0 + np.exp(-(x - 0.5) @ along / width))
        return np.stack([1.0 - second, second], axis=1)

    return share


def _disc(rng, phases):
    """One disc in the middle."""
    return lambda x: (((x - 0.5) ** 2).sum(axis=1) < DISC**2).astype(int)


def _stripe(rng, phases):
    """One stripe along y in the middle."""
    return lambda x: (np.abs(x[:, 0] - 0.5) < STRIPE / 2).astype(int)


_DRAWN = {
    "disc": _disc,
    "stripe": _stripe,
    "islands": _islands,
    "strokes": _strokes,
    "discs": _discs,
    "slope": _slope,
    "none": _nowhere,
}
