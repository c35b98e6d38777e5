"""The schema of the configuration.

A configuration names geometries, materials, loads, noise levels, methods and specimens; ``cases``
combine them and ``grid`` blocks expand products of them into more cases.
"""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Positive = Annotated[float, Field(gt=0)]


NonNegative = Annotated[float, Field(ge=0)]


Fraction = Annotated[float, Field(ge=0, le=1)]


Count = Annotated[int, Field(ge=1)]


Point = tuple[float, float]


class Section(BaseModel):
    """A mapping with a fixed set of keys."""

    model_config = ConfigDict(extra="forbid", strict=False, frozen=True)
