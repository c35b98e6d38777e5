"""Materials, loads, noise and camera of synthetic cases."""

import difflib
from typing import Literal, Union

from pydantic import ConfigDict, Field, model_validator

from hypernode.config.section import Count, NonNegative, Positive, Section
from hypernode.mechanics.parameters import PARAMETERS

LoadKind = Literal["equibiaxial", "biaxial", "uniaxial_x", "uniaxial_y", "clamped_x", "clamped_y", "shear"]


class Material(Section):
    """A closed-form material: ``model`` and its parameters; fibre_angle in degrees."""

    model_config = ConfigDict(extra="allow", frozen=True)
    model: Literal[tuple(PARAMETERS)]

    @model_validator(mode="before")
    @classmethod
    def _parameters(cls, values):
        if not isinstance(values, dict) or str(values.get("model")) not in PARAMETERS:
            return values
        wanted = PARAMETERS[values["model"]]
        for key, value in values.items():
            if key == "model":
                continue
            if key not in wanted:
                near = difflib.get_close_matches(key, wanted, 1)
                hint = f"; did you mean '{near[0]}'?" if near else ""
                raise ValueError(f"'{key}' is not a parameter of {values['model']} ({', '.join(wanted)}){hint}")
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                raise ValueError(f"'{key}' must be a number, not {value!r}")
            lower, upper = wanted[key]
            if not lower <= value <= upper:
                raise ValueError(f"'{key}' = {value!r} is outside {lower:g} ... {upper:g}")
        missing = [key for key in wanted if key not in values]
        if missing:
            raise ValueError(f"{values['model']} also needs {', '.join(missing)}")
        return values

    @property
    def parameters(self) -> dict[str, float]:
        """Parameter values by name, as written (fibre_angle in degrees)."""
        return dict(self.model_extra)


class Load(Section):
    """A load case: its kind and the edge stretch of every step."""

    kind: LoadKind
    stretches: list[Union[Positive, tuple[Positive, Positive]]] = Field(min_length=1)

    @model_validator(mode="after")
    def _pairs(self):
        if any(isinstance(s, tuple) != (self.kind == "biaxial") for s in self.stretches):
            wanted = "pairs [x, y]" if self.kind == "biaxial" else "single numbers"
            raise ValueError(f"stretches of a {self.kind} load are {wanted}")
        return self


class Noise(Section):
    """Measurement error of the displacement, in the length unit of the test."""

    sigma: NonNegative = 0.0
    repeats: Count = 1
    seed: int = Field(default=0, ge=0)


class Layer(Section):
    """A further phase, drawn over what is already there."""

    geometry: str
    material: str


class Camera(Section):
    """A measured grid of its own: so that data and identification do not share a mesh.

    ``cells`` of the measured grid, and ``window``, the side of the correlation window over which the
    displacement is averaged, in the length unit of the sheet.
    """

    cells: tuple[Count, Count]
    window: NonNegative = 0.0
