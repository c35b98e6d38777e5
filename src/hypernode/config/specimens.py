"""Real tests."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from hypernode.config.section import Count, Fraction, NonNegative, Positive, Section


class Specimen(Section):
    """A real test: where its files are and how to read them.

    Lengths in mm, times in s, forces in N. Either ``frames`` (numbers) or ``stretches`` (target
    mean stretches along the tensile axis) selects the load steps. ``force_offset`` is subtracted from the force
    record: what it reads before the sheet pulls. ``force_uncertainty``: of the force that the grid carries, relative:
    the load cell's, and that of the share of the sheet's width that is left of it. ``relaxation``: tell from the
    record which share of the force is a matter of time, and identify without it. ``correlation_window`` is the
    side of the window over which the cameras' software averages the displacement, 0 where it is not known.
    """

    folder: str
    format: Literal["davis"] = "davis"
    force_file: str = "force_disp.csv"
    published_at: str = ""
    load: Literal["clamped_x", "clamped_y"] = "clamped_y"
    width: Positive
    height: Positive
    thickness: Positive
    pixel_size: Positive
    frame_rate: Positive
    first_frame_time: float = 0.0
    force_offset: float = 0.0
    force_uncertainty: Fraction = 0.01
    relaxation: bool = True
    edge_ring: Annotated[int, Field(ge=0)] = 1
    frames: list[Count] | None = None
    stretches: list[Annotated[float, Field(gt=1)]] | None = None
    noise_pixels: Positive = 0.3
    correlation_window: NonNegative = 0.0
    shape_image: str | None = None
    shape_flipped: bool = False
    source_title: str = ""

    @model_validator(mode="after")
    def _selection(self):
        if (self.frames is None) == (self.stretches is None):
            raise ValueError("give either frames or stretches")
        return self
