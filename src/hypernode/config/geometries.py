"""Shapes of inclusions and holes."""

from typing import Annotated, Literal, Union

from pydantic import ConfigDict, Field, model_validator

from hypernode.config.section import Fraction, NonNegative, Point, Positive, Section


class Glyph(Section):
    """A letter, digit or word drawn from DejaVu Sans."""

    model_config = ConfigDict(coerce_numbers_to_str=True)

    shape: Literal["glyph"]
    text: str = Field(min_length=1)
    height: Positive = 0.6
    centre: Point = (0.5, 0.5)
    bold: bool = True


class Ellipse(Section):
    """An ellipse; a disc has equal semi-axes."""

    shape: Literal["ellipse"]
    semi_axes: tuple[Positive, Positive]
    centre: Point = (0.5, 0.5)
    angle: float = 0.0


class Disc(Section):
    """A disc."""

    shape: Literal["disc"]
    radius: Positive
    centre: Point = (0.5, 0.5)


class Ring(Section):
    """The points between two concentric circles."""

    shape: Literal["ring"]
    inner_radius: NonNegative
    outer_radius: Positive
    centre: Point = (0.5, 0.5)

    @model_validator(mode="after")
    def _ordered(self):
        if self.inner_radius >= self.outer_radius:
            raise ValueError("inner_radius must be smaller than outer_radius")
        return self


class Image(Section):
    """The bright pixels of an image, stretched over the sheet, first row at the top."""

    shape: Literal["image"]
    path: str
    threshold: Fraction = 0.5
    invert: bool = False


class Gradient(Section):
    """A smooth transition across the sheet with no jump."""

    shape: Literal["gradient"]
    direction: float = 0.0
    profile: Literal["linear", "sine"] = "linear"


class Uniform(Section):
    """One phase everywhere."""

    shape: Literal["uniform"]


Geometry = Annotated[Union[Glyph, Ellipse, Disc, Ring, Image, Gradient, Uniform], Field(discriminator="shape")]
