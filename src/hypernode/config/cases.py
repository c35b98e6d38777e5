"""Cases: a sheet and its tests, and the methods that identify its material."""

from typing import Literal, Union

from pydantic import Field, model_validator

from hypernode.config.section import Count, Positive, Section
from hypernode.config.synthetic import Camera, FurtherPhase

#: Points along a side from which noise can be told: fewer say nothing of it.
FEWEST_POINTS = 6


class Sheet(Section):
    """What a written case and the cases of a grid have in common."""

    loads: list[str] = []
    """Load cases of the test."""
    hole: str | None = None
    """Geometry inside which there is no material; the unit square of a specimen is its measured field."""
    cells: tuple[Count, Count] = (50, 50)
    """Finite elements along x and y; as many as in the paper."""
    size: tuple[Positive, Positive] = (1.0, 1.0)
    """Sides of the sheet along x and y, in the length unit of the test."""
    thickness: Positive | None = None
    """Thickness of a synthetic sheet in mm, whose moduli are in MPa and forces in N; left out, the thickness is 1 and
    moduli are in Pa."""
    spacing: tuple[Positive, Positive] = (1.0, 1.0)
    """Ratio of the last to the first cell's side along x and y."""
    camera: Camera | None = None
    """Measured grid; left out, displacements are measured at the nodes of the finite elements."""
    mesh: Literal["finer", "measured_grid"] = "measured_grid"
    """What an identification is told of the displacements of a synthetic case without camera: measured_grid, that they
    are those of finite elements on the grid; or finer, nothing, as of a sheet in a laboratory."""
    methods: list[str] = ["hypernode"]
    """Presets, or methods of this configuration, that identify the material."""


class Case(Sheet):
    """One sheet and its tests: a synthetic one (geometry, materials, loads) or a specimen.

    ``methods: []`` is for a specimen that others are compared with and that is itself not identified.
    """

    geometry: str | None = None
    """Geometry of the inclusion."""
    inclusion: str | None = None
    """Material inside the geometry."""
    matrix: str | None = None
    """Material outside it."""
    noise: str | None = None
    """Measurement error; left out, there is none."""
    specimen: str | None = None
    """The real test that is identified, in the place of geometry, materials and loads."""
    further_phases: list[FurtherPhase] = []
    """Further phases, drawn over the first two in this order."""
    unseen_loads: list[str] = []
    """Load cases that are computed with the identified field afterwards and compared with the truth."""
    references: dict[Literal["matrix", "inclusion", "whole"], str] = {}
    """Reference sheets of a specimen. `matrix` and `inclusion` name the case of a sheet of that phase alone, whose
    forces are compared with those of the identified phase. `whole` names a case of unused frames of the same test."""
    judged_stretches: list[Positive] | None = None
    """Stretches at which identified and true stress are compared; left out, those of the test."""

    @model_validator(mode="after")
    def _one_kind(self):
        synthetic = {"geometry": self.geometry, "matrix": self.matrix, "loads": self.loads or None}
        if self.specimen:
            given = [key for key, value in synthetic.items() if value]
            if given or self.inclusion or self.noise or self.further_phases or self.camera or self.unseen_loads:
                raise ValueError("a specimen has no geometry, materials, loads or noise of its own")
            if self.thickness:
                raise ValueError("the thickness of a specimen is said under 'specimens', with its width and height")
        else:
            if self.references:
                raise ValueError("references are for specimens: a synthetic case is compared with its truth")
            missing = [key for key, value in synthetic.items() if not value]
            if missing:
                raise ValueError(f"a synthetic case also needs {', '.join(missing)} (or name a specimen)")
            if self.camera and self.hole:
                raise ValueError("a camera grid cannot be laid over a sheet with a hole")
            if self.camera and self.mesh == "measured_grid" and "mesh" in self.model_fields_set:
                raise ValueError(
                    "a camera does not measure at the nodes of the finite elements: leave out mesh or camera"
                )
            if self.photographed:
                _refuse_few_points(self.camera, self.size)
        return self

    @property
    def photographed(self) -> bool:
        """Whether displacements are those of correlated pictures."""
        return bool(self.camera and self.camera.pictures)


def _refuse_few_points(camera: Camera, size: tuple[float, float]) -> None:
    settings, pixel = camera.correlated, camera.pixel_size(size)
    smallest = settings.footprint + (FEWEST_POINTS - 1) * settings.step
    if min(size) / pixel < smallest:
        raise ValueError(
            f"pictures of {min(size) / pixel:.0f} pixels across the sheet hold less than {FEWEST_POINTS} correlated "
            f"points of subset {settings.footprint} and step {settings.step}: take more pixels, {smallest} at least, "
            "or a smaller subset or step"
        )


class Grid(Sheet):
    """A product of lists: one case for every combination, named by the template ``name``.

    A value that is a list of names is swept; the template refers to it by its key, for example
    ``{geometry}_{noise}``. ``loads`` and ``methods`` are not swept: they are lists already.
    """

    name: str
    """Template of the cases' names, with every swept key in it."""
    geometry: Union[str, list[str]]
    """Geometry of the inclusion, or several."""
    inclusion: Union[str, list[str], None] = None
    """Material inside the geometry, or several."""
    matrix: Union[str, list[str]]
    """Material outside it, or several."""
    noise: Union[str, list[str], None] = None
    """Measurement error, or several."""
    loads: list[str]
    """Load cases of every test."""
    methods: list[str] = Field(default=["hypernode"], min_length=1)
    """Presets, or methods of this configuration, that identify the material of every case."""


class Population(Grid):
    """Many synthetic sheets of which only the identified field, its evaluation and tables by group are kept.

    A grid of cases that are not run stage by stage but by jobs of many sheets each; they have no figures.
    """

    batch: Count = 20
    """Most sheets that one job identifies; they are of one geometry and one pair of materials."""
    seeds: Count = 1
    """Tests of every sheet with each noise, which differ in their seed alone: the noise's own and those after it. The
    template refers to noise and seed together as ``{noise}``: the name of the noise, or with several seeds NOISE-SEED.
    """
    methods: list[str] = Field(default=["field"], min_length=1, max_length=1)
    """The one method, without networks and with a constrained field, a preset or of this configuration."""
