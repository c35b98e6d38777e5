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
#: How displacement files may be laid out, by the software that writes them; ``auto``: as the files themselves show.
Format = Literal[
    "auto", "davis", "davis_mm", "davis_stereo", "davis8", "matchid_2024", "matchid_2023", "matchid_2d",
    "matchid_matrices", "vic3d", "vic2d", "vic2d_mm", "dice", "dice_subsets", "gom", "gom_nodemap", "ncorr", "pyvale",
    "al_dic", "table",
]  # fmt: skip
#: Load steps where none are asked for: as many as in the paper's experiment.
LOAD_STEPS = 5


class Table(Section):
    """Columns of displacement files that no known software wrote."""

    x: str = "x"
    """Name of the column of the position along x, without its unit."""
    y: str = "y"
    """The same along y."""
    u: str = "u"
    """Name of the column of the displacement along x, without its unit."""
    v: str = "v"
    """The same along y."""
    unit: Literal["pixel", "mm"] | None = None
    """Unit of positions and displacements; needed where the names of the columns do not end in it, as in `x [mm]`."""
    delimiter: Annotated[str, Field(min_length=1, max_length=1)] = ","
    """What stands between cells; a blank stands for any run of blanks."""
    decimal: Literal[".", ","] = "."
    """Decimal sign."""
    deformed: bool = False
    """Whether positions are those in the deformed sheet."""


class Specimen(Section):
    """A real test. ``frames``, ``stretches`` or ``load_steps`` selects its load steps; only one of them is given."""

    folder: str
    """Folder with the frames and the force record, from the folder in which the workflow runs."""
    format: Format = "auto"
    """Software that exported the frames, where the files do not show it themselves."""
    table: Table = Table()
    """Columns of the frames where the format is `table`."""
    y_points: Literal["up", "down"] | None = None
    """Where y of the frames points, if otherwise than their format has it."""
    allow_out_of_plane: bool = False
    """Whether a sheet that stereo cameras saw move out of its plane by more than 5 % of its size is read."""
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
    pixel_size: Positive | None = None
    """Length of a pixel on the sheet [mm]; frames in mm need none."""
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
    noise_mm: Positive | None = None
    """The same in mm, instead; needed where no pixel size is given."""
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

    @model_validator(mode="after")
    def _noise_is_known(self):
        if self.pixel_size is None and self.noise_mm is None:
            raise ValueError("give pixel_size, or noise_mm where the frames are in mm")
        return self

    @property
    def displacement_noise(self) -> float:
        """Standard deviation of a measured displacement [mm]."""
        return self.noise_mm if self.noise_mm is not None else self.noise_pixels * self.pixel_size
