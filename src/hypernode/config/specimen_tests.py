"""One real test of a specimen: its frames, its load and its force record. Lengths in mm, times in s, forces in N."""

from typing import Annotated, Literal, Union

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from hypernode.config.section import Count, Fraction, NonZero, Positive, Section

#: How a specimen may be loaded.
SpecimenLoad = Literal[
    "clamped_x", "clamped_y", "uniaxial_x", "uniaxial_y", "biaxial", "biaxial_clamped", "shear", "general"
]
#: Programs whose force records are known: the names of ``hypernode.dic.forces.dialects``.
ForceFormat = Literal[
    "named_columns",
    "wavematrix",
    "named_axes",
    "named_axes_brackets",
    "bluehill_3",
    "bluehill_universal",
    "zwick_testxpert",
    "mts_testsuite",
    "cellscale_biotester",
    "davis_load",
    "davis_channels",
    "matchid_image",
    "wavematrix",
    "cellscale_univert",
    "usual_names",
    "usual_names_brackets",
    "usual_names_suffix",
    "pictures",
    "pictures_brackets",
    "pictures_suffix",
]
#: How displacement files may be laid out, by the software that writes them; ``auto``: as the files themselves show.
Format = Literal[
    "auto", "davis", "davis_mm", "davis_stereo", "davis8", "matchid_2024", "matchid_2023", "matchid_2d",
    "matchid_matrices", "vic3d", "vic2d", "vic2d_mm", "dice", "dice_subsets", "gom", "gom_nodemap", "ncorr", "pyvale",
    "al_dic", "arrays", "table",
]  # fmt: skip
#: The machine's axes.
Axis = Literal["x", "y"]


#: An axis of the sheet, and the way along it.
Way = Literal["x", "y", "-x", "-y"]
#: What a test says of the errors of its forces, and a measurement in the same words.
FORCE_ERRORS = ("force_uncertainty", "force_gain_uncertainty", "force_offset_uncertainty")
#: What selects load steps; only one of them is given.
SELECTIONS = ("frames", "stretches", "times", "load_steps")
#: Load steps where none are asked for: as many as in the paper's experiment.
LOAD_STEPS = 5


#: Name of a column, or its number.
Column = Annotated[str, BeforeValidator(lambda said: str(said) if type(said) is int else said)]
#: What stands between cells; a tab by its name.
Delimiter = Annotated[str, Field(pattern="^(.|tab)$"), AfterValidator(lambda said: "\t" if said == "tab" else said)]


class Table(Section):
    """Columns of displacement files that no known software wrote."""

    x: Column = "x"
    """Name of the column of the position along x, without its unit; its number, from 1 on, where no line has names."""
    y: Column = "y"
    """Name or number of the column of the position along y."""
    u: Column = "u"
    """Name of the column of the displacement along x, without its unit."""
    v: Column = "v"
    """Name or number of the column of the displacement along y."""
    unit: Literal["pixel", "mm"] | None = None
    """Unit of positions and displacements; needed where the names of the columns do not end in it, as in `x [mm]`."""
    delimiter: Delimiter = ","
    """What stands between cells, one letter or `tab`; a blank stands for any run of blanks."""
    decimal: Literal[".", ","] | None = None
    """Decimal sign; the file shows it where it is left out."""
    deformed: bool = False
    """Whether positions are those in the deformed sheet."""
    positions: bool = False
    """Whether u and v hold positions in the deformed sheet in the place of displacements."""
    frame: Column | None = None
    """Name of the column with the number of the frame, where one table holds all of them."""


class Arrays(Section):
    """Arrays of a file of npz, HDF5 or MATLAB, by their usual names where left out: DIC_X, DIC_disp, instron_force
    and instron_disp."""

    positions: str | None = None
    """Name of the array of positions (point, 2) or (row, column, 2)."""
    displacements: str | None = None
    """Name of the array of displacements (frame, point, 2) or (frame, row, column, 2), the sheet at rest first."""
    force: str | None = None
    """Name of the array of forces (frame,) [N]."""
    crosshead: str | None = None
    """Name of the array of the crosshead's way (frame,) [mm]."""
    time: str | None = None
    """Name of the array of times (frame,) [s]."""
    unit: Literal["pixel", "mm"] | None = None
    """Unit of positions and displacements, which such a file does not say; of DIC_X it is known to be mm."""


class SpecimenTest(Section):
    """One test. ``frames``, ``stretches``, ``times`` or ``load_steps`` selects its load steps; only one is given."""

    folder: str
    """Folder with the frames and the force record, from the folder in which the workflow runs."""
    format: Format = "auto"
    """Software that exported the frames, where the files do not show it themselves."""
    table: Table = Table()
    """Columns of the frames where the format is `table`."""
    arrays: Arrays = Arrays()
    """Arrays of the frames where one file holds them all."""
    y_points: Literal["up", "down"] | None = None
    """Direction in which y of the frames points, if it differs from that of their format."""
    valid: dict[str, tuple[Union[float, None], Union[float, None]]] = Field(default_factory=dict)
    """Columns of the frames that say which points count, each with the smallest and the largest value of those that do;
    null for no such bound. Columns of known programs mark failed points by themselves."""
    implied_reference: bool | None = None
    """Whether the sheet at rest, from which displacements are, is in no file; left out, as the software has it."""
    newest_first: bool = False
    """Whether the numbers of the files run backwards in time; frames are then numbered from the oldest on."""
    increments: bool = False
    """Whether displacements are those of each point since the frame before; they are added up."""
    displacement_factor: Positive | None = None
    """What displacements of the frames are multiplied by, where they are in another unit than positions. Left out, 1,
    and a sheet that narrows as if it were pulled much further, or less, is said; 1 says that they are right."""
    displacement_axes: tuple[Way, Way] = ("x", "y")
    """Axes of the files' positions along which their u and v point: `[y, x]` where the columns are swapped, `[x, -y]`
    where v points the other way."""
    repeated_frames: Literal["inserted", "missed"] | None = None
    """What a frame is that equals the one before to the last bit: inserted, so that those after it are earlier, or in
    the place of a picture that the camera missed. Left out, the motion tells."""
    allow_out_of_plane: bool = False
    """Whether a sheet that stereo cameras saw move out of its plane by more than 5 % of its size is read."""
    load: SpecimenLoad = "clamped_y"
    """How the sheet is held and pulled: clamped at two ends; uniaxial, free to contract at its ends; biaxial, by rakes
    or hooks; biaxial_clamped, as a cruciform; shear, its clamped top moved along x; general, in no simple way."""
    force_file: str | None = "force_disp.csv"
    """The testing machine's record in that folder; which program wrote it is told by its content. null: no force was
    recorded, and the material is known up to one factor."""
    force_format: ForceFormat | None = None
    """Program that wrote the record, where its content does not tell."""
    force_channel: Union[str, dict[Axis, str], None] = None
    """Name of the record's column with the force, or that along each axis, where it is not the usual one."""
    time_channel: str | None = None
    """Name of the record's column with the time, where it is not the usual one."""
    force_set: str | None = None
    """Set of cycles that is used of a record of several."""
    force_cycle: str | None = None
    """Cycle that is used of a record of several."""
    picture_shift: int | None = None
    """What the record's number of a picture is more than that of its frame; left out, it is zero, or found where the
    record has as many pictures as there are frames."""
    crosshead: bool = True
    """Whether the crosshead or actuator of the record moves the ends of the sheet; false where it moves something else,
    and is not to be compared with the frames."""
    pixel_size: Positive | None = None
    """Length of a pixel on the sheet [mm]; frames in mm need none."""
    frame_rate: Positive | None = None
    """Frames in a second [1/s]; not needed where the record names its pictures or the frames say their times."""
    first_frame_time: float = 0.0
    """Time of the first frame in the clock of the force record [s]."""
    force_time_offset: Union[float, Literal["estimate"], None] = None
    """Seconds by which the force record's clock is ahead of the times of the frames, or estimate, which takes it from
    the motion that both show. Where it is left out, a lag that the curve of force and stretch tells is taken out, and
    clocks that disagree are an error."""
    force_offset: Union[float, dict[Axis, float], None] = None
    """What the force record reads before the sheet pulls [N], or along each axis; it is subtracted. Left out, it is
    zero, and a record that reads something else at the first frame is refused; 0 takes that for a preload."""
    force_factor: NonZero = 1.0
    """What forces of the record are multiplied by, before force_offset: 9.80665 where it says N and means kilograms, -1
    where it counts tension as negative."""
    force_uncertainty: Fraction = 0.01
    """Relative uncertainty of a force that no other force shares. What the unseen share of the width leaves open is
    told by the identified field, and comes on top."""
    force_gain_uncertainty: Fraction = 0.01
    """Relative uncertainty of the load cell's gain, which all forces of a test along one axis share: 1 % of a machine
    of class 1 after ISO 7500-1."""
    force_offset_uncertainty: Fraction = 0.001
    """Uncertainty of the load cell's zero over the largest force, which all forces of a test along one axis share:
    0.1 % of that class."""
    relaxation: bool = True
    """Whether to tell from the record which share of the force is a matter of time, and identify without it."""
    camera_motion: bool = True
    """Whether to take out what the camera moved and turned between the frames, as far as the held edges show it."""
    camera_growth: Union[float, Literal["ends"], None] = None
    """Share by which pictures after the first are larger, as those of a sheet nearer to the camera are. It is taken
    out. `ends`: the share by which both held ends get longer. Left out, it is 0, and a growth in the frames is asked
    about."""
    grid_offset: tuple[float, float] | None = None
    """Lower left corner of the field, from that of the first test [mm]; left out, their centres are one point."""
    frames: list[Count] | None = None
    """Numbers of the frames that become load steps."""
    stretches: list[Annotated[float, Field(gt=1)]] | None = None
    """Mean stretches along the pull (1 + shear where the sheet is sheared); the nearest frames become load steps."""
    times: list[float] | None = None
    """Times in the clock of the frames [s]; the nearest frames become load steps."""
    load_steps: Count | None = None
    """Number of load steps, evenly spaced in mean stretch up to the largest one: 5 where nothing else selects them,
    fewer where there are not as many frames."""
    loading: Union[Annotated[int, Field(ge=1)], Literal["last"]] = "last"
    """Which of several loadings gives the load steps where the sheet is unloaded in between, counted from 1, or the
    last. It counts where `frames` and `times` do not choose."""
    noise_pixels: Positive | None = None
    """Standard deviation of a measured displacement [pixel]; left out, it is estimated from the frames."""
    noise_mm: Positive | None = None
    """Standard deviation of a measured displacement [mm], instead of `noise_pixels`."""

    @model_validator(mode="before")
    @classmethod
    def _selection(cls, values):
        if not isinstance(values, dict):
            return values
        given = [key for key in SELECTIONS if values.get(key) is not None]
        if len(given) > 1:
            raise ValueError(f"give only one of {', '.join(given)}: each of them selects the load steps")
        return values if given else {**values, "load_steps": LOAD_STEPS}

    @model_validator(mode="after")
    def _one_noise(self):
        if self.noise_pixels is not None and self.noise_mm is not None:
            raise ValueError("give only one of noise_pixels, noise_mm")
        return self

    @model_validator(mode="after")
    def _both_axes(self):
        if self.displacement_axes[0].lstrip("-") == self.displacement_axes[1].lstrip("-"):
            raise ValueError("displacement_axes: one of both is along x and the other along y, as [y, x] or [x, -y]")
        return self

    @property
    def steps(self) -> int:
        """Largest number of load steps that the selection gives."""
        return self.load_steps or len(self.frames or self.stretches or self.times)

    def force_zero(self, axis: Axis) -> float:
        """What the record reads along an axis before the sheet pulls [N]."""
        given = self.force_offset
        return given.get(axis, 0.0) if isinstance(given, dict) else given or 0.0

    def stated_noise(self, mm: float) -> float | None:
        """Standard deviation of a displacement [mm] as configured, or None; ``mm`` is the unit of the frames [mm]."""
        if self.noise_mm is not None:
            return self.noise_mm
        return self.noise_pixels * (self.pixel_size or mm) if self.noise_pixels is not None else None
