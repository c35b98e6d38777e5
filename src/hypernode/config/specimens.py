"""Real sheets and their tests: where the files are and how to read them. Lengths in mm, times in s, forces in N."""

from typing import Literal

from pydantic import Field, model_validator

from hypernode.config.section import Fraction, NonNegative, NonNegativeInt, Positive
from hypernode.config.specimen_tests import SELECTIONS, SpecimenTest


class Specimen(SpecimenTest):
    """A real sheet and its test, or several ``tests``, which take over what the specimen says and they do not."""

    tests: list[SpecimenTest] = []
    """Further tests of the same sheet, identified together: repeats, cycles, other loads. Where they are given, the
    specimen itself is none, and what it says holds for each of them that says nothing else."""
    published_at: str = ""
    """Place where the data are published; shown where the folder is absent."""
    optional: bool = Field(default=False, exclude=True)
    """Whether cases of this specimen are left out where its folder is absent, which is otherwise an error."""
    width: Positive
    """Side of the sheet along x [mm]: across which a force along y is carried."""
    height: Positive
    """Side of the sheet along y [mm]."""
    thickness: Positive
    """Thickness of the sheet [mm]: the mean one where it is not the same everywhere."""
    plane: Literal["stress", "strain"] = "stress"
    """What the faces of the sheet do: stress, they are free, as of a thin sheet; or strain, the thickness stays, as of
    a thick body or one between plates. Strain needs a method with the term J, and E and nu are then those of it."""
    thickness_uncertainty: Fraction = 0.01
    """Relative standard uncertainty of the thickness, which the level of the stress follows: that of callipers on a
    soft sheet."""
    pixel_size_uncertainty: Fraction = 0.005
    """Relative standard uncertainty of the pixel size, by default that of a scale in the picture. The level of the
    stress depends on it where the points cover the whole sheet."""
    camera_distance_uncertainty: Fraction = 0.0002
    """Standard uncertainty of the distance between camera and sheet during a test, over the distance. Every strain is
    off by as much. The default is a motion of 0.1 mm, seen from half a metre."""
    thickness_map: str | None = None
    """Table of the thickness from place to place: columns x, y, thickness [mm], from the lower left corner of the
    measured field."""
    outline: Literal["cut", "edge"] = "cut"
    """What the outermost points are: lines within the sheet, whose displacement is known and whose forces are not; or
    the edge of the sheet itself, free where nothing holds it."""
    edge_ring: NonNegativeInt | None = None
    """Outermost rings of points that are dropped, since correlation windows reach over the edge there: 1 where the
    outline is cut, 0 where it is the edge of the sheet."""
    correlation_window: NonNegative = 0.0
    """Side of the window over which the cameras' software averages the displacement [mm]. Where it is not stated, 0, a
    sheet of two materials tells it, with a warning."""
    correlation_kernel: Literal["average", "quadratic"] = "average"
    """What it does over that window: average, as subsets that deform affinely do, or quadratic, the middle of a
    quadratic fit, as subsets of second order do."""
    mesh: Literal["finer", "measured_grid"] = "finer"
    """What the displacements come from: finer, a sheet or a mesh whose interfaces may cut cells of the grid; or
    measured_grid, bilinear finite elements whose nodes are the points, so that none does."""
    noise_uncertainty: Fraction = 0.05
    """Relative standard deviation of the noise level itself: estimates from frames of known noise scatter by 0.05; 0
    where errors were drawn with a known level."""
    shape_image: str | None = None
    """Image of the printed inclusion, with which the identified one is compared; or a file of arrays with positions and
    a label of every point."""
    shape_flipped: bool = False
    """Whether the first row of that image is at the bottom."""
    source_title: str = ""
    """What the specimen is, in titles of files."""

    @model_validator(mode="before")
    @classmethod
    def _inherited(cls, values):
        """Tests take over what the specimen says; a specimen of several has the folder of its first."""
        if not isinstance(values, dict) or not isinstance(values.get("tests"), list) or not values["tests"]:
            return values
        shared = {key: value for key, value in values.items() if key in SpecimenTest.model_fields}
        tests = [_with_defaults(shared, test) if isinstance(test, dict) else test for test in values["tests"]]
        first = tests[0].get("folder") if isinstance(tests[0], dict) else None
        return {**values, "tests": tests, "folder": values.get("folder") or first}

    @model_validator(mode="after")
    def _edge_is_kept(self):
        if self.outline == "edge" and self.edge_ring:
            raise ValueError(
                f"edge_ring = {self.edge_ring} drops points on the edge of the sheet, so that the outermost are not "
                "on it: outline: cut, or no edge_ring"
            )
        return self

    @property
    def all_tests(self) -> list[SpecimenTest]:
        """Its tests, in the order of their load cases."""
        return self.tests or [self]

    @property
    def dropped_rings(self) -> int:
        """Rings of points that are dropped."""
        if self.edge_ring is not None:
            return self.edge_ring
        return 0 if self.outline == "edge" else 1


def _with_defaults(shared: dict, test: dict) -> dict:
    """A test with what its specimen says, but for a selection of load steps where it has one of its own."""
    selects = any(test.get(key) is not None for key in SELECTIONS)
    kept = {key: value for key, value in shared.items() if not (selects and key in SELECTIONS)}
    return {**kept, **test}
