"""Shapes of phases. Coordinates are those of the unit square, which is stretched over the sheet; angles in degrees."""

from typing import Annotated, Literal, Union

from pydantic import ConfigDict, Field, model_validator

from hypernode.config.section import Fraction, NonNegative, Point, Positive, Section


class Glyph(Section):
    """A letter, digit or word drawn from DejaVu Sans."""

    model_config = ConfigDict(coerce_numbers_to_str=True)

    shape: Literal["glyph"]
    text: str = Field(min_length=1, json_schema_extra={"type": ["string", "integer"]})
    """Letters or digits."""
    height: Positive = 0.6
    """Height of the glyph."""
    centre: Point = (0.5, 0.5)
    """Centre of the glyph."""
    bold: bool = True
    """Whether the strokes are bold, so that several cells span them."""


class Ellipse(Section):
    """An ellipse; a disc has equal semi-axes."""

    shape: Literal["ellipse"]
    semi_axes: tuple[Positive, Positive]
    """Semi-axes, along x and y before the ellipse is turned."""
    centre: Point = (0.5, 0.5)
    """Centre of the ellipse."""
    angle: float = 0.0
    """Angle by which it is turned, anticlockwise [degrees]."""


class Disc(Section):
    """A disc."""

    shape: Literal["disc"]
    radius: Positive
    """Radius of the disc."""
    centre: Point = (0.5, 0.5)
    """Centre of the disc."""


class Ring(Section):
    """The points between two concentric circles."""

    shape: Literal["ring"]
    inner_radius: NonNegative
    """Radius of the hole."""
    outer_radius: Positive
    """Outer radius, larger than the inner one."""
    centre: Point = (0.5, 0.5)
    """Centre of both circles."""

    @model_validator(mode="after")
    def _ordered(self):
        if self.inner_radius >= self.outer_radius:
            raise ValueError("inner_radius must be smaller than outer_radius")
        return self


class Stroke(Section):
    """A line drawn by hand with a round pen, smooth through its points; with two it is straight."""

    shape: Literal["stroke"]
    points: list[Point] = Field(min_length=2)
    """Points that the pen passes, in order."""
    width: Positive
    """Width of the line."""


class Image(Section):
    """The bright pixels of an image, stretched over the sheet, first row at the top; transparent ones never count."""

    shape: Literal["image"]
    path: str
    """The image, from the folder in which the workflow runs."""
    threshold: Fraction = 0.5
    """Brightness from which a pixel belongs to the shape, 0 black, 1 white."""
    invert: bool = False
    """Whether the dark pixels are the shape instead."""


class Gradient(Section):
    """A smooth transition across the sheet with no jump."""

    shape: Literal["gradient"]
    direction: float = 0.0
    """Direction of the transition, anticlockwise from x [degrees]."""
    profile: Literal["linear", "sine"] = "linear"
    """Course of the transition along it."""


class Uniform(Section):
    """One phase everywhere."""

    shape: Literal["uniform"]


Geometry = Annotated[Union[Glyph, Ellipse, Disc, Ring, Stroke, Image, Gradient, Uniform], Field(discriminator="shape")]
