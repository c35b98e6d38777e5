"""What every section of the configuration is made of."""

import re
from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

#: Names of entries become parts of file names.
NAME = re.compile(r"^[A-Za-z0-9][A-Za-z0-9_.-]*$")


def _non_zero(value: float) -> float:
    if value == 0.0:
        raise ValueError("a factor of 0 leaves nothing")
    return value


#: A factor that may turn a sign.
NonZero = Annotated[float, AfterValidator(_non_zero), Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]
Fraction = Annotated[float, Field(ge=0, le=1)]
Count = Annotated[int, Field(ge=1)]
#: A number of something that may be none, or the seed of random numbers.
NonNegativeInt = Annotated[int, Field(ge=0)]
Point = tuple[float, float]


class Section(BaseModel):
    """A mapping with a fixed set of keys; what each means, in which unit, stands below it and in the JSON Schema."""

    model_config = ConfigDict(extra="forbid", strict=False, frozen=True)
