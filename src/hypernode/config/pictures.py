"""How a synthetic test is photographed: the speckle on the sheet, and what the camera does to it. Lengths in pixels."""

from typing import Annotated

from pydantic import Field, model_validator

from hypernode.config.section import NonNegative, NonNegativeInt, Section

#: A grey level of eight bits.
Grey = Annotated[float, Field(ge=0, le=255)]
#: Largest relative displacement by a lens that is still slight: beyond it the picture may fold over.
_MOST_DISTORTED = 0.1


class Speckle(Section):
    """Dark discs that are sprayed at random on the sheet."""

    diameter: Annotated[float, Field(ge=1)] = 5.0
    """Mean diameter [pixel]; three to five pixels are usual."""
    share: Annotated[float, Field(gt=0, lt=1)] = 0.5
    """Share of the sheet that they cover."""
    seed: NonNegativeInt = 0
    """Seed of their places."""


class Pictures(Section):
    """Pictures of a synthetic test, in grey levels of eight bits."""

    pixels: Annotated[int, Field(ge=64)] = 420
    """Pixels along the longer side of the sheet at rest."""
    margin: Annotated[int, Field(ge=4)] = 20
    """Pixels between the sheet, where it is stretched most, and the edge of the picture."""
    speckle: Speckle = Speckle()
    """What is sprayed on the sheet."""
    dark: Grey = 40.0
    """Grey level of the speckle."""
    bright: Grey = 200.0
    """Grey level of the sheet between it."""
    background: Grey = 20.0
    """Grey level beside the sheet."""
    noise: NonNegative = 2.0
    """Standard deviation of the camera's noise, of each pixel of each picture [grey level]."""
    defocus: NonNegative = 0.5
    """Standard deviation of the Gaussian with which the lens blurs the picture [pixel]."""
    distortion: Annotated[float, Field(ge=-_MOST_DISTORTED, le=_MOST_DISTORTED)] = 0.0
    """How far the lens moves the corners of the picture outward, over their distance from its centre; it grows with
    the third power of that distance, and no calibration takes it out again."""
    seed: NonNegativeInt = 0
    """Seed of the camera's noise."""

    @model_validator(mode="after")
    def _contrast(self):
        if not self.dark < self.bright:
            raise ValueError(f"dark = {self.dark:g} is not darker than bright = {self.bright:g}: no speckle is seen")
        return self
