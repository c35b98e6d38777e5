"""Which phase of a heterogeneous sheet each point belongs to."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from jaxtyping import Float

Shape = Callable[[Float[np.ndarray, "point 2"]], Float[np.ndarray, " point"]]


def _rotated(X, centre, angle):
    c, s = np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))
    d = X - np.asarray(centre)
    return c * d[:, 0] + s * d[:, 1], -s * d[:, 0] + c * d[:, 1]


def glyph(text: str, height: float, centre=(0.5, 0.5), bold: bool = True) -> Shape:
    """A letter or word of DejaVu Sans, ``height`` tall, its bounding box centred at ``centre``."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextPath

    font = FontProperties(family="DejaVu Sans", weight="bold" if bold else "normal")
    path = TextPath((0.0, 0.0), text, size=1.0, prop=font)
    polygons = [p for p in path.to_polygons(closed_only=True) if len(p) > 3]
    corners = np.concatenate(polygons)
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    scale = height / (upper[1] - lower[1])

    def inside(X):
        from matplotlib.path import Path as Outline

        local = (X - np.asarray(centre)) / scale + 0.5 * (lower + upper)
        # Even-odd rule over the outlines: the counter of a P is an outline inside an outline.
        crossings = sum(Outline(p).contains_points(local).astype(int) for p in polygons)
        return (crossings % 2).astype(float)

    return inside


def ellipse(semi_axes, centre=(0.5, 0.5), angle: float = 0.0) -> Shape:
    """An ellipse whose first semi-axis makes ``angle`` degrees with x; a disc where both are equal."""

    def inside(X):
        a, b = _rotated(X, centre, angle)
        return ((a / semi_axes[0]) ** 2 + (b / semi_axes[1]) ** 2 <= 1.0).astype(float)

    return inside


def ring(inner_radius: float, outer_radius: float, centre=(0.5, 0.5)) -> Shape:
    """Points between two concentric circles."""

    def inside(X):
        r = np.hypot(*(X - np.asarray(centre)).T)
        return ((r >= inner_radius) & (r <= outer_radius)).astype(float)

    return inside


def stroke(points, width: float) -> Shape:
    """Points no further than half of ``width`` from the cubic spline through ``points``."""
    from scipy.interpolate import CubicSpline
    from scipy.spatial import cKDTree

    through = np.asarray(points, float)
    course = CubicSpline(np.arange(len(through)), through)
    # Spots a hundredth of the width apart: between two of them the rim is off by less than a thousandth.
    length = np.linalg.norm(np.diff(through, axis=0), axis=1).sum()
    pen = cKDTree(course(np.linspace(0.0, len(through) - 1.0, 2 + int(100.0 * length / width))))
    return lambda X: (pen.query(X)[0] <= 0.5 * width).astype(float)


def _luminance_and_opacity(picture):
    """Both of every pixel, from 0 to 1."""
    if picture.mode.startswith("I"):
        # Pillow would cut 16 bits off at what 8 bits hold.
        deep = np.asarray(picture, dtype=float) / 65535.0
        return deep, np.ones_like(deep)
    return np.moveaxis(np.asarray(picture.convert("LA"), dtype=float) / 255.0, -1, 0)


def image(path: str | Path, threshold: float = 0.5, invert: bool = False) -> Shape:
    """Bright pixels of an image stretched over the unit square, first row at the top.

    Args:
        path: any format that Pillow reads; colour is reduced to luminance, and what is transparent is outside.
        threshold: luminance, from 0 to 1, above which a pixel belongs to the shape.
        invert: take the dark pixels instead.

    Raises:
        ValueError: the file is no image, or all or none of its pixels belong to the shape.
    """
    from PIL import Image

    try:
        with Image.open(path) as picture:
            luminance, opacity = _luminance_and_opacity(picture)
    except OSError as error:
        raise ValueError(f"{path}: cannot be read as an image: {error}") from None
    chosen = ((luminance > threshold) != invert) & (opacity > 0.5)
    if chosen.all() or not chosen.any():
        raise ValueError(
            f"{path}: {'every' if chosen.all() else 'no'} pixel belongs to the shape: luminance goes from "
            f"{luminance.min():.3g} to {luminance.max():.3g}, so choose a threshold between, or invert"
        )
    chosen = chosen[::-1]

    def inside(X):
        rows, columns = chosen.shape
        j = np.clip((X[:, 0] * columns).astype(int), 0, columns - 1)
        i = np.clip((X[:, 1] * rows).astype(int), 0, rows - 1)
        within = ((X >= 0.0) & (X <= 1.0)).all(axis=1)
        return (chosen[i, j] & within).astype(float)

    return inside


def gradient(direction: float = 0.0, profile: str = "linear") -> Shape:
    """A smooth transition from 0 to 1 across the unit square with no jump.

    Args:
        direction: angle of the steepest ascent from x [degrees].
        profile: ``linear``, or ``sine`` for one half wave.
    """

    def inside(X):
        a, _ = _rotated(X, (0.5, 0.5), direction)
        c, s = np.cos(np.deg2rad(direction)), np.sin(np.deg2rad(direction))
        t = np.clip(0.5 + a / (abs(c) + abs(s)), 0.0, 1.0)
        return t if profile == "linear" else 0.5 - 0.5 * np.cos(np.pi * t)

    return inside


def uniform() -> Shape:
    """No inclusion anywhere."""
    return lambda X: np.zeros(len(X))


def disc(radius: float, centre=(0.5, 0.5)) -> Shape:
    """A disc."""
    return ellipse((radius, radius), centre)


SHAPES: Mapping[str, Callable[..., Shape]] = {
    "glyph": glyph,
    "ellipse": ellipse,
    "disc": disc,
    "ring": ring,
    "stroke": stroke,
    "image": image,
    "gradient": gradient,
    "uniform": uniform,
}


def make_shape(geometry) -> Shape:
    """The shape of a configured geometry: a function from unit-square points to inclusion share."""
    return SHAPES[geometry.shape](**{k: v for k, v in geometry.model_dump().items() if k != "shape"})
