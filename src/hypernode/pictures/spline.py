"""Grey levels between the pixels of a picture, and what becomes of their noise there."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Float
from scipy.ndimage import map_coordinates, spline_filter

#: Order of the splines between pixels: their own error is below the noise of eight bits.
_ORDER = 5


@dataclass(frozen=True)
class Spline:
    """A picture between its pixels."""

    coefficients: Float[np.ndarray, "row column"]

    @classmethod
    def of(cls, picture: Float[np.ndarray, "row column"]) -> "Spline":
        """The spline through the grey levels of all pixels."""
        return cls(spline_filter(picture, order=_ORDER, mode="mirror"))

    def at(self, x: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "..."]:
        """Grey levels at (column, row), NaN beyond the picture."""
        where = [x[..., 1], x[..., 0]]
        grey = map_coordinates(self.coefficients, where, order=_ORDER, mode="mirror", prefilter=False)
        rows, columns = self.coefficients.shape
        out = (x < 0.0).any(axis=-1) | (x[..., 0] > columns - 1) | (x[..., 1] > rows - 1)
        grey[out] = np.nan
        return grey

    def gradient(self, x: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
        """Derivative of grey levels along columns and rows; at a pixel it has no part in the noise of that pixel."""
        # The spline is smooth: central differences over a hundredth of a pixel are as good as its derivative.
        step = 0.01
        return np.stack([(self.at(x + d) - self.at(x - d)) / (2.0 * step) for d in step * np.eye(2)], axis=-1)

    def curvature(self, x: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2 2"]:
        """Second differences of grey levels over a pixel."""
        ends = 0.5 * np.eye(2)

        def second(d, e):
            return self.at(x + d + e) - self.at(x + d - e) - self.at(x - d + e) + self.at(x - d - e)

        return np.stack([np.stack([second(d, e) for e in ends], axis=-1) for d in ends], axis=-2)


def noise_between(x: Float[np.ndarray, "... 2"]) -> float:
    """Mean share of the variance of pixels' noise that a spline through them has at places (column, row).

    Half-way between pixels it is a mean of several.
    """
    half = 4 * _ORDER
    pixel = np.zeros(2 * half + 1)
    pixel[half] = 1.0
    weights = spline_filter(pixel, order=_ORDER, mode="mirror")
    shift = np.linspace(0.0, 1.0, 33)
    at = shift[:, None] + np.arange(half // 2, 3 * half // 2)
    each = map_coordinates(weights, [at.ravel()], order=_ORDER, mode="mirror", prefilter=False).reshape(at.shape)
    share = np.interp(x % 1.0, shift, (each**2).sum(axis=1))
    return float(share.prod(axis=-1).mean())


@cache
def slope_noise() -> float:
    """Variance of the slope of a spline through pixels along a line, over that of their noise."""
    picture = np.zeros((1 + 8 * _ORDER, 1 + 8 * _ORDER))
    picture[4 * _ORDER, 4 * _ORDER] = 1.0
    row = np.stack([np.arange(2.0, 8 * _ORDER - 1), np.full(8 * _ORDER - 3, 4.0 * _ORDER)], axis=-1)
    return float((Spline.of(picture).gradient(row)[:, 0] ** 2).sum())
