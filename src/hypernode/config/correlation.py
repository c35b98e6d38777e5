"""How points are followed through pictures."""

from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from hypernode.config.section import Count, Section

#: Pixels at each side of a finite element's node that must lie on the sheet: those at its outline show what is beside.
OUTLINE = 3
#: al-dic has a mesh of squares that are halved and halved again.
STEPS_OF_AL_DIC = (4, 8, 16, 32, 64)


class Correlation(Section):
    """Which engine follows the points, and the squares of pixels that it compares."""

    engine: Literal["pyvale", "al_dic", "finite_elements"] = "pyvale"
    """pyvale: each subset by itself; al_dic: subsets that a mesh holds together; finite_elements: none, the material is
    identified from the grey levels themselves, and of the other keys ``step`` alone counts."""
    subset: Annotated[int, Field(ge=9)] = 25
    """Side of the square around a point that is compared [pixel]; odd."""
    step: Count = 8
    """Distance of the points [pixel]; at most the subset; for al_dic a power of two. Of finite elements their side,
    even, since grey levels are told on elements half as large."""
    shape: Literal["affine", "quadratic"] = "affine"
    """How a subset may deform; quadratic with pyvale alone."""
    incremental: bool = False
    """Compare each picture with the one before and add up, instead of with the first: where a picture is too unlike
    the first."""
    reach: Annotated[int, Field(ge=4)] = 64
    """Largest displacement between two compared pictures that is looked for [pixel]; less than half a picture."""

    @field_validator("subset")
    @classmethod
    def _odd(cls, value: int) -> int:
        if value % 2 == 0:
            raise ValueError(f"subset = {value} must be odd, so that it has a pixel in its middle")
        return value

    @property
    def footprint(self) -> int:
        """Side of the square around a point that must lie on the sheet [pixel]."""
        return 2 * OUTLINE if self.engine == "finite_elements" else self.subset

    @model_validator(mode="after")
    def _what_an_engine_has(self):
        if self.engine == "finite_elements":
            if self.step % 2:
                raise ValueError(f"step = {self.step} must be even for finite_elements: grey levels are told by halves")
            if self.incremental or self.shape != "affine":
                raise ValueError(
                    "finite_elements compare every picture with the first, by elements: leave out incremental and shape"
                )
            return self
        if self.step > self.subset:
            raise ValueError(f"step = {self.step} must be at most the subset, {self.subset}")
        if self.engine == "al_dic" and self.step not in STEPS_OF_AL_DIC:
            steps = ", ".join(map(str, STEPS_OF_AL_DIC))
            raise ValueError(f"step = {self.step}: the engine al_dic takes {steps} only")
        if self.engine == "al_dic" and self.shape == "quadratic":
            raise ValueError("shape: quadratic needs the engine pyvale: subsets of al_dic deform affinely")
        return self
