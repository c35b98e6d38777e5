"""A speckle pattern: discs of scattered size at random places, and how much light they leave."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.ndimage import map_coordinates, spline_filter
from scipy.special import erfc

from hypernode.config.pictures import Speckle

#: Diameters are spread evenly by this share of the mean one to both sides: drops of a spray are not alike.
SCATTER = 0.3
#: Standard deviation of the Gaussian that softens the rim of a disc [pixel]: wide enough for the samples below.
RIM = 0.5
#: Samples a pixel of the pattern, between which it is interpolated by cubic splines.
SAMPLES = 4
#: Standard deviations of the rim beyond which a disc is not seen.
_REACH = 4.0
#: Samples around the sheet, so that the spline has no end within it.
_BORDER = 8


@dataclass(frozen=True)
class Discs:
    """Dark discs on a sheet, in pixels of it at rest, from its lower left corner, y upward."""

    centre: Float[np.ndarray, "disc 2"]
    radius: Float[np.ndarray, " disc"]


def sprayed(size: tuple[float, float], speckle: Speckle) -> Discs:
    """Discs at random places, as many as cover the stated share of the sheet.

    Discs that overlap cover a share of 1 - exp(-density * mean area), the Boolean model of Chiu, Stoyan, Kendall and
    Mecke, Stochastic Geometry and its Applications (2013), section 3.1.

    Args:
        size: sides of the sheet at rest [pixel].
    """
    random = np.random.default_rng(speckle.seed)
    mean = 0.5 * speckle.diameter
    reach = (1.0 + SCATTER) * mean + _REACH * RIM
    # A soft disc leaves as little light, all in all, as a sharp one of radius^2 + RIM^2.
    area = np.pi * (mean**2 * (1.0 + SCATTER**2 / 3.0) + RIM**2)
    width, height = (side + 2.0 * reach for side in size)
    count = round(-np.log1p(-speckle.share) / area * width * height)
    centre = random.uniform(-reach, (size[0] + reach, size[1] + reach), (count, 2))
    return Discs(centre, mean * random.uniform(1.0 - SCATTER, 1.0 + SCATTER, count))


@dataclass(frozen=True)
class Pattern:
    """The light that a sheet sends back: 1 between the discs, 0 within.

    Attributes:
        spline: coefficients of the cubic spline through samples, upward and to the right.
    """

    spline: Float[np.ndarray, "row column"]

    @classmethod
    def of(cls, discs: Discs, size: tuple[float, float]) -> "Pattern":
        """The pattern of discs on a sheet with these sides [pixel]."""
        columns, rows = (int(np.ceil(side * SAMPLES)) + 2 * _BORDER + 1 for side in size)
        light = np.ones((rows, columns))
        for centre, radius in zip(discs.centre * SAMPLES + _BORDER, discs.radius * SAMPLES, strict=True):
            reach = radius + _REACH * RIM * SAMPLES
            low = np.maximum(np.ceil(centre - reach).astype(int), 0)
            high = np.minimum(np.floor(centre + reach).astype(int) + 1, (columns, rows))
            if (low >= high).any():
                continue
            x, y = (np.arange(low[k], high[k]) - centre[k] for k in (0, 1))
            distance = np.hypot(x[None, :], y[:, None])
            covered = 0.5 * erfc((distance - radius) / (np.sqrt(2.0) * RIM * SAMPLES))
            light[low[1] : high[1], low[0] : high[0]] *= 1.0 - covered
        return cls(spline_filter(light, order=3, mode="mirror"))

    def at(self, X: Float[np.ndarray, "point 2"]) -> Float[np.ndarray, " point"]:
        """Light at points of the sheet at rest [pixel]."""
        return map_coordinates(self.spline, (X * SAMPLES + _BORDER).T[::-1], order=3, mode="mirror", prefilter=False)
