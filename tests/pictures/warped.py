"""Pictures of a speckle that a known displacement has warped."""

import numpy as np
from scipy.ndimage import gaussian_filter, map_coordinates

#: Pixels of pattern around the picture, from which it may come into view.
MARGIN = 60


def pattern(side, seed=0):
    """Random grey around 128 with grains of about five pixels, MARGIN wider than a picture on every side."""
    random = np.random.default_rng(seed)
    grey = gaussian_filter(random.standard_normal((side + 2 * MARGIN,) * 2), 2.0, mode="wrap")
    return 128.0 + 45.0 * grey / grey.std()


def warped(grey, displacement):
    """The picture after `displacement(column, row) -> (columns right, rows down)` of the reference."""
    side = len(grey) - 2 * MARGIN
    row, column = np.mgrid[:side, :side].astype(float)
    X, Y = column.copy(), row.copy()
    for _ in range(60):
        right, down = displacement(X, Y)
        X, Y = column - right, row - down
    seen = map_coordinates(grey, [Y + MARGIN, X + MARGIN], order=5, mode="reflect")
    return np.clip(np.round(seen), 0, 255).astype(np.uint8)


def stretched(side, most):
    """A sheet pulled along its rows: stretches between 1 + 0.6 and 1 + 1 times `most` within it."""
    half = side / 2

    def displacement(column, row):
        x, y = column / half - 1.0, row / half - 1.0
        right = most * half * (0.8 * x + 0.2 * np.sin(np.pi * x) / np.pi)
        return right, -0.3 * most * half * y

    return displacement
