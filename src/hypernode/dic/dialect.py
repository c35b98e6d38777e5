"""What there is to know about the layout of a displacement file."""

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, field

#: How a number that is none is written, in lower case.
NOT_A_NUMBER = (
    *("", "nan", "-nan", "non un numero reale", "n. def.", "nicht numerisch"),
    *("nan(ind)", "-nan(ind)", "nan(snan)", "-nan(snan)", "1.#qnan", "-1.#qnan", "1.#ind", "-1.#ind"),
    *("1.#inf", "-1.#inf", "1.#nan", "#num!", "#zahl!", "n.a."),
    *("na", "n/a", "#n/a", "#nv", "#wert!", "#value!", "#div/0!", "nil", "null", "none", "-", "--", "---", "*"),
)


@dataclass(frozen=True)
class Dialect:
    """One layout of exported displacements.

    Attributes:
        name: as the configuration says it.
        software: as messages say it.
        recognised: column names that a header of this dialect has, with their unit in brackets where that decides.
        x, y, u, v: names of the columns of position and displacement, without unit.
        z, w: the same out of the plane; a file that has both is stereo.
        absent: column names that it has not.
        unit: of positions and displacements where the header names none.
        displacement_factor: what displacements are multiplied by, beside what their unit says.
        displacement_axes: along which u and v of the files point.
        layouts: delimiters and decimal signs in which it comes; where both signs are possible, the numbers show theirs.
        y_up: whether y points upward.
        v_up: whether v does, where it differs from y.
        deformed: whether positions are those in the deformed sheet.
        positions: whether u and v are positions in the deformed sheet too, in the place of displacements.
        lost: (column, value) pairs that mark a lost point.
        valid: column -> smallest and largest value of points that count; None where there is no such bound.
        arrays: positions, displacements and force -> name of the array that holds them, where a file holds arrays.
        zero_is_lost: whether a displacement of exactly zero in a deformed frame marks one.
        blanks: whether an empty cell or a word for "not a number" marks one.
        lost_position: whether a lost point still has its true position.
        reference: whether the reference is exported as the first frame.
        incremental: text of the preamble that says that displacements are increments.
        time, force: names of their columns.
        frame: name of the column with the number of the frame.
        preamble_unit, preamble_force: expressions whose group is the unit of length, and the force, in the preamble.
        content: how the file is made. ``frame`` is a table a frame, ``subset`` a table a point, ``matrices`` a file a
            field. ``ncorr``, ``arrays`` and ``stacked`` are one file for all,
            the last a table with a column ``frame``. ``davis8`` has a first line instead of a header.
    """

    name: str
    software: str
    _: KW_ONLY
    recognised: tuple[str, ...] = ()
    x: tuple[str, ...] = ("x",)
    y: tuple[str, ...] = ("y",)
    u: tuple[str, ...] = ("u",)
    v: tuple[str, ...] = ("v",)
    z: tuple[str, ...] = ()
    w: tuple[str, ...] = ()
    absent: tuple[str, ...] = ()
    unit: str | None = None
    displacement_factor: float = 1.0
    displacement_axes: tuple[str, str] = ("x", "y")
    layouts: tuple[tuple[str, str], ...] = ((",", "."),)
    y_up: bool = True
    v_up: bool | None = None
    deformed: bool = False
    positions: bool = False
    lost: tuple[tuple[str, float], ...] = ()
    valid: Mapping[str, tuple[float | None, float | None]] = field(default_factory=dict)
    arrays: Mapping[str, str | None] = field(default_factory=dict)
    zero_is_lost: bool = False
    blanks: bool = False
    lost_position: bool = True
    reference: bool = True
    incremental: str | None = None
    time: str | None = None
    force: str | None = None
    frame: str | None = None
    preamble_unit: str | None = None
    preamble_force: str | None = None
    content: str = "frame"

    def option(self, **said: str) -> str:
        """Words of the command line that declare a table of these columns, with what is said besides."""
        columns = {role: getattr(self, role)[0] for role in "xyuv"} | ({"frame": self.frame} if self.frame else {})
        columns = {role: name if name.isdigit() else repr(name) for role, name in columns.items()}
        mark = self.layouts[0][0]
        # YAML does not read Python's two letters for a tab as one.
        sign = {} if mark == "," else {"delimiter": "tab" if mark == "\t" else repr(mark)}
        told = ", ".join(f"{key}: {value}" for key, value in (columns | sign | said).items())
        return f'--set format=table --set "table={{{told}}}"'
