"""What synthetic tests are made of: materials, load cases, noise, further phases and the camera."""

import difflib
from typing import Literal, Union

from pydantic import ConfigDict, Field, model_validator

from hypernode.config.correlation import Correlation
from hypernode.config.pictures import Pictures
from hypernode.config.section import Count, Fraction, NonNegative, NonNegativeInt, Positive, Section
from hypernode.mechanics.parameters import NONZERO, PARAMETERS

LoadKind = Literal[
    "equibiaxial", "biaxial", "uniaxial_x", "uniaxial_y", "clamped_x", "clamped_y", "shear", "biaxial_clamped"
]


class Material(Section):
    """A closed-form material: ``model`` and its parameters; fibre_angle in degrees, moduli in Pa, or in MPa of sheets
    with a thickness."""

    model_config = ConfigDict(extra="allow", frozen=True)
    model: Literal[tuple(PARAMETERS)]
    """The closed form."""

    @model_validator(mode="before")
    @classmethod
    def _parameters(cls, values):
        if not isinstance(values, dict) or str(values.get("model")) not in PARAMETERS:
            return values
        wanted = PARAMETERS[values["model"]]
        values = {key: _number(value) for key, value in values.items()}
        for key, value in values.items():
            if key == "model":
                continue
            if key not in wanted:
                near = difflib.get_close_matches(str(key), wanted, 1)
                hint = f"; did you mean '{near[0]}'?" if near else ""
                raise ValueError(f"'{key}' is not a parameter of {values['model']} ({', '.join(wanted)}){hint}")
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                raise ValueError(f"'{key}' must be a number, not {value!r}")
            if key in NONZERO and value == 0.0:
                raise ValueError(f"'{key}' must not be zero: the energy of {values['model']} is over it")
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


def _number(value):
    """A number that is written as text, as on the command line, as a number; anything else as it is."""
    try:
        return float(value) if isinstance(value, str) else value
    except ValueError:
        return value


class Load(Section):
    """A load case: its kind and the edge stretch of every step."""

    kind: LoadKind
    """Which edges are pulled, and whether they may contract: clamped ones may not."""
    stretches: list[Union[Positive, tuple[Positive, Positive]]] = Field(min_length=1)
    """Edge stretch of each step: a number, a pair [x, y] for biaxial, 1 + shear for shear."""

    @model_validator(mode="after")
    def _pairs(self):
        if any(isinstance(s, tuple) != (self.kind == "biaxial") for s in self.stretches):
            wanted = "pairs [x, y]" if self.kind == "biaxial" else "single numbers"
            raise ValueError(f"stretches of a {self.kind} load are {wanted}")
        return self


class Noise(Section):
    """Measurement errors of displacements and forces. An identification is told their sizes, but not of outliers."""

    sigma: NonNegative = 0.0
    """Standard deviation, in the length unit of the sheet."""
    repeats: Count = 1
    """How often each step is measured."""
    seed: NonNegativeInt = 0
    """Seed of the errors."""
    correlation_length: NonNegative = 0.0
    """Standard deviation of the Gaussian, in grid steps, with which errors of neighbouring points are smoothed; 0:
    each has its own."""
    outliers: Fraction = 0.0
    """Share of the displacements that are off by ``outlier_size`` in a random direction."""
    outlier_size: NonNegative = 0.0
    """By how much an outlier is off, in the length unit of the sheet."""
    force: Fraction = 0.0
    """Relative standard deviation of the force of each step."""
    force_gain: Fraction = 0.0
    """Relative standard deviation of the load cell's gain along each axis; all steps of a load case share the error."""
    force_offset: Fraction = 0.0
    """Standard deviation of the load cell's zero, over the largest force."""


class FurtherPhase(Section):
    """A further phase, drawn over what is already there."""

    geometry: str
    """Name of the geometry inside which it is."""
    material: str
    """Name of its material."""


class Camera(Section):
    """How a sheet is measured: on a grid of its own, or by pictures that are correlated."""

    cells: tuple[Count, Count] | None = None
    """Cells of a measured grid along x and y, so that data and identification do not share a mesh."""
    window: NonNegative = 0.0
    """Side of the correlation window over which the displacement is averaged, in the length unit of the sheet."""
    pictures: Pictures | None = None
    """Pictures of the sheet, in the place of `cells` and `window`: the noise of displacements is that of correlating
    them, and the measured grid is that of the correlated points."""
    correlation: Correlation | None = None
    """How pictures are correlated, or that they are not; left out, as the defaults say."""

    @model_validator(mode="after")
    def _one_way(self):
        if (self.cells is None) == (self.pictures is None):
            raise ValueError("a camera has either cells, of a grid at which it measures, or pictures")
        if self.pictures is None and self.correlation:
            raise ValueError("correlation is of pictures: give pictures, {} for their defaults, or leave it out")
        if self.pictures and self.window:
            raise ValueError("the window of pictures is the subset of their correlation: leave window out")
        return self

    @property
    def correlated(self) -> Correlation:
        """How its pictures are correlated."""
        return self.correlation or Correlation()

    def pixel_size(self, size: tuple[float, float]) -> float:
        """Length of a pixel of its pictures on a sheet with these sides, in their unit."""
        return max(size) / self.pictures.pixels

    def grid_cells(self, size: tuple[float, float]) -> int:
        """Number of cells of the measured grid, of pictures as many as fit with all subsets on the sheet."""
        if self.cells:
            return self.cells[0] * self.cells[1]
        settings, pixel = self.correlated, self.pixel_size(size)
        columns, rows = (int(max(side / pixel - settings.footprint, 0.0) / settings.step) for side in size)
        return columns * rows
