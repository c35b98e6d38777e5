"""What the configuration says of a test's frames that their files do not show."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Literal

from hypernode.config.specimen_tests import SpecimenTest


@dataclass(frozen=True, kw_only=True)
class Declared:
    """Keys of a test of the same names.

    Attributes:
        y_points: where y of the files points, if otherwise than their dialect says.
        valid: column -> smallest and largest value of points that count.
        implied_reference: whether the sheet at rest is in no file; None where the dialect says it.
        newest_first: whether the numbers of the files run backwards in time.
        increments: whether displacements are those since the frame before.
        displacement_factor: what displacements are multiplied by; None for one.
        displacement_axes: along which u and v of the files point.
        repeated_frames: what a frame means that is equal to the one before; None where the others tell.
        allow_out_of_plane: whether a stereo sheet may move far out of its plane.
    """

    y_points: str | None = None
    valid: Mapping[str, tuple[float | None, float | None]] = field(default_factory=dict)
    implied_reference: bool | None = None
    newest_first: bool = False
    increments: bool = False
    displacement_factor: float | None = None
    displacement_axes: tuple[str, str] = ("x", "y")
    repeated_frames: Literal["inserted", "missed"] | None = None
    allow_out_of_plane: bool = False


def declared_by(test: SpecimenTest) -> Declared:
    """What a test declares."""
    return Declared(**{each.name: getattr(test, each.name) for each in fields(Declared)})
