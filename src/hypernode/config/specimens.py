"""Real tests: where their files are and how to read them. Lengths in mm, times in s, forces in N."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from hypernode.config.section import Count, Fraction, NonNegative, NonNegativeInt, Positive, Section

#: Programs whose force records are known: the names of ``hypernode.dic.force_dialects``.
ForceFormat = Literal[
    "named_columns",
    "bluehill_3",
    "bluehill_universal",
    "zwick_testxpert",
    "mts_testsuite",
    "cellscale_biotester",
    "davis_load",
    "davis_channels",
    "matchid_image",
]
#: Load steps where none are asked for: as many as in the paper's experiment.
LOAD_STEPS = 5


class Specimen(Section):
    """A real test. ``frames``, ``stretches`` or ``load_steps`` selects its load steps; only one of them is given."""

    folder: str
    """Folder with the frames and the force record, from the folder in which the workflow runs."""
    format: Literal["davis"] = "davis"
    """Software that exported the frames."""
    force_file: str = "force_disp.csv"
    """The testing machine's record in that folder; which program wrote it is told by its content."""
    force_format: ForceFormat | None = None
    """Program that wrote the record, where its content does not tell."""
    force_channel: str | None = None
    """Name of the record's column with the force, where it is not the usual one of its program."""
    force_set: str | None = None
    """Set of cycles that is used of a record of several."""
    force_cycle: str | None = None
    """Cycle that is used of a record of several."""
    published_at: str = ""
    """Where the data can be found; shown where the folder is absent."""
    optional: bool = Field(default=False, exclude=True)
    """Whether cases of this specimen are left out where its folder is absent, which is otherwise an error."""
    load: Literal["clamped_x", "clamped_y"] = "clamped_y"
    """Direction of the pull; the sheet is clamped at both ends."""
    width: Positive
    """Side of the sheet along x [mm]."""
    height: Positive
    """Side of the sheet along y [mm]."""
    thickness: Positive
    """Thickness of the sheet [mm]."""
    pixel_size: Positive
    """Length of a pixel on the sheet [mm]."""
    frame_rate: Positive
    """Frames in a second [1/s]."""
    first_frame_time: float = 0.0
    """Time of the first frame in the clock of the force record [s]."""
    force_time_offset: float | Literal["estimate"] | None = None
    """Seconds by which the force record's clock is ahead of the times of the frames, or estimate, which takes it from
    the motion that both show. Where it is left out, clocks that disagree are an error."""
    force_offset: float = 0.0
    """What the force record reads before the sheet pulls [N]; it is subtracted."""
    force_uncertainty: Fraction = 0.01
    """Relative uncertainty of the force that the grid carries: the load cell's, and that of the share of the sheet's
    width that is left of it."""
    relaxation: bool = True
    """Whether to tell from the record which share of the force is a matter of time, and identify without it."""
    edge_ring: NonNegativeInt = 1
    """Outermost rings of points that are dropped, since correlation windows reach over the edge there."""
    frames: list[Count] | None = None
    """Numbers of the frames that become load steps."""
    stretches: list[Annotated[float, Field(gt=1)]] | None = None
    """Mean stretches along the pull; the nearest frames become load steps."""
    load_steps: Count | None = None
    """Number of load steps, evenly spaced in mean stretch up to the largest one: 5 where nothing else selects them,
    fewer where there are not as many frames."""
    noise_pixels: Positive = 0.3
    """Standard deviation of a measured displacement [pixel]."""
    correlation_window: NonNegative = 0.0
    """Side of the window over which the cameras' software averages the displacement [mm]; 0 where it is not known."""
    shape_image: str | None = None
    """Image of the printed inclusion, with which the identified one is compared."""
    shape_flipped: bool = False
    """Whether the first row of that image is at the bottom."""
    source_title: str = ""
    """What the specimen is, in titles of files."""

    @model_validator(mode="before")
    @classmethod
    def _selection(cls, values):
        if not isinstance(values, dict):
            return values
        given = [key for key in ("frames", "stretches", "load_steps") if values.get(key) is not None]
        if len(given) > 1:
            raise ValueError(f"give only one of {', '.join(given)}: each of them selects the load steps")
        return values if given else {**values, "load_steps": LOAD_STEPS}
