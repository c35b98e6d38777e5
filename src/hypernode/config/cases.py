"""Cases: sheets and their tests, one by one or as products."""

from typing import Literal, Union

from pydantic import Field, model_validator

from hypernode.config.section import Count, Positive, Section
from hypernode.config.synthetic import Camera, Layer


class Case(Section):
    """One sheet and its tests: a synthetic one (geometry, materials, loads) or a specimen.

    ``hole`` names a geometry where there is no material; ``layers`` are phases drawn over the first
    two; ``spacing`` is the ratio of the last to the first cell's side along x and y; ``camera`` measures
    on a grid that is not the finite-element mesh. ``unseen_loads`` are computed with the identified
    field and compared with the truth. ``references`` of a specimen: phase -> case of a sheet that consists of
    it, whose forces are compared with those of the identified phase, or whole -> case of frames that were not used.
    """

    geometry: str | None = None
    inclusion: str | None = None
    matrix: str | None = None
    loads: list[str] = []
    noise: str | None = None
    specimen: str | None = None
    layers: list[Layer] = []
    hole: str | None = None
    cells: tuple[Count, Count] = (50, 50)
    size: tuple[Positive, Positive] = (1.0, 1.0)
    spacing: tuple[Positive, Positive] = (1.0, 1.0)
    camera: Camera | None = None
    unseen_loads: list[str] = []
    references: dict[Literal["matrix", "inclusion", "whole"], str] = {}
    methods: list[str] = []
    judged_stretches: list[Positive] | None = None

    @model_validator(mode="after")
    def _one_kind(self):
        synthetic = {"geometry": self.geometry, "matrix": self.matrix, "loads": self.loads or None}
        if self.specimen:
            given = [key for key, value in synthetic.items() if value]
            if given or self.inclusion or self.noise or self.layers or self.hole or self.camera or self.unseen_loads:
                raise ValueError("a specimen has no geometry, materials, loads or noise of its own")
        else:
            if self.references:
                raise ValueError("references are for specimens: a synthetic case is compared with its truth")
            missing = [key for key, value in synthetic.items() if not value]
            if missing:
                raise ValueError(f"a synthetic case also needs {', '.join(missing)} (or name a specimen)")
            if self.camera and self.hole:
                raise ValueError("a camera grid cannot be laid over a sheet with a hole")
        return self


class Grid(Section):
    """A product of lists: one case for every combination, named by the template ``name``.

    A value that is a list of names is swept; the template refers to it by its key, for example
    ``{geometry}_{noise}``. ``loads`` and ``methods`` are not swept: they are lists already.
    """

    name: str
    geometry: Union[str, list[str]]
    inclusion: Union[str, list[str], None] = None
    matrix: Union[str, list[str]]
    noise: Union[str, list[str], None] = None
    loads: list[str]
    methods: list[str] = Field(min_length=1)
    hole: str | None = None
    cells: tuple[Count, Count] = (50, 50)
    size: tuple[Positive, Positive] = (1.0, 1.0)
    spacing: tuple[Positive, Positive] = (1.0, 1.0)
    camera: Camera | None = None
