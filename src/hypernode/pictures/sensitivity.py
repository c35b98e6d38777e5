"""How well a speckle pattern tells a displacement, whatever correlates it."""

import numpy as np
from jaxtyping import Bool, Float, UInt8
from scipy.ndimage import binary_erosion

#: Pixels at the outline whose gradient is that of the background, not of the speckle.
_OUTLINE = 3


def least_noise(
    picture: UInt8[np.ndarray, "row column"], mask: Bool[np.ndarray, "row column"], grey_noise: float, subset: int
) -> Float[np.ndarray, " 2"]:
    """Standard deviation of a correlated displacement along columns and rows that grey noise alone makes [pixel].

    It is the root of two times that noise over the root of the sum of the squared gradients of a subset, here a mean
    one. After Pan, Xie, Wang, Qian and Wang, Study on subset size selection in digital image correlation for speckle
    patterns (2008).

    Args:
        picture: of the sheet at rest.
        mask: where the sheet is.
        grey_noise: standard deviation of each pixel of a picture [grey level].
        subset: side of a subset [pixel].
    """
    inside = binary_erosion(mask, iterations=_OUTLINE)
    along_rows, along_columns = np.gradient(picture.astype(float))
    # Noise has gradients as well: of a difference of two pixels over two.
    squared = np.array([(each[inside] ** 2).mean() - 0.5 * grey_noise**2 for each in (along_columns, along_rows)])
    return np.sqrt(2.0) * grey_noise / (subset * np.sqrt(squared))
