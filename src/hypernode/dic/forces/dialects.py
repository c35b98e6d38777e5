"""What the force records of testing machines and cameras look like: a table, and nothing else.

A column's name is compared without its unit, without blanks around it and in lower case.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

#: The axis of a machine that pulls along one only.
PULL = "pull"


@dataclass(frozen=True, kw_only=True)
class ForceDialect:
    """How one program writes a record.

    Attributes:
        name: in the configuration.
        program: in messages.
        time: names of its column [s unless a unit says otherwise].
        force: names of its column by axis; no names where the unit alone tells.
        displacement: names of the crosshead's or actuator's column by axis.
        image: names of the column with the number of the picture, or the picture's file.
        units: in a row below the names, in brackets behind each name or after a sign as in ``Force / N``, or behind
            its last underscore.
        also: further columns that the header must have.
        begins: how the first line of the file begins.
        preamble: largest number of lines above the header.
        delimiters: tried in this order.
        cycles: columns that tell the set and the cycle of a row.
    """

    name: str
    program: str
    time: tuple[str, ...]
    force: Mapping[str, tuple[str, ...]]
    displacement: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    image: tuple[str, ...] = ()
    units: Literal["row", "brackets", "suffix"] = "row"
    also: tuple[str, ...] = ()
    begins: str = ""
    preamble: int = 60
    delimiters: str = ",;\t"
    cycles: tuple[str, str] | None = None

    def ways(self, axis: str) -> tuple[str, ...]:
        """Names of the crosshead's column along an axis: its own, and the usual ones where it has one at all."""
        own = tuple(self.displacement.get(axis, ()))
        return (*own, *WAY_NAMES) if own and axis == PULL else own


#: Names of columns in the languages of usual machines and loggers: time, force, way, and number of a picture.
TIME_NAMES = (
    *("time", "elapsed time", "total time", "running time", "test time", "t", "zeit", "gesamtzeit", "prüfzeit"),
    *("laufzeit", "messzeit", "temps", "temps écoulé", "temps ecoule", "time stamp", "timestamp", "x_value"),
    *("uhrzeit", "zeitstempel", "heure", "horodatage", "hora", "ora", "clock", "date time", "datetime", "date/time"),
    *("tiempo", "tempo", "tijd", "tid", "czas", "čas", "aika", "zaman", "время", "时间", "時間"),
)
FORCE_NAMES = (
    *("force", "load", "axial force", "axial load", "tensile force", "standard force", "force 1", "load cell", "f"),
    *("kraft", "last", "zugkraft", "standardkraft", "effort", "charge", "force axiale"),
    *("fuerza", "carga", "forza", "carico", "força", "forca", "kracht", "siła", "sila", "síla", "voima", "kuvvet"),
    *("сила", "усилие", "нагрузка", "力", "载荷", "负荷", "荷重", "試験力"),
)
WAY_NAMES = (
    *("displacement", "extension", "crosshead", "crosshead displacement", "position", "stroke", "axial displacement"),
    *("weg", "traversenweg", "standardweg", "verschiebung", "déplacement", "deplacement", "traverse", "allongement"),
    *(
        "desplazamiento",
        "extensión",
        "alargamiento",
        "spostamento",
        "corsa",
        "allungamento",
        "deslocamento",
        "verplaatsing",
        "förskjutning",
        "przemieszczenie",
    ),
    *("siirtymä", "перемещение", "位移", "変位", "ストローク"),
)
PICTURE_NAMES = (
    *("image", "image index", "image number", "image no", "image no.", "image file", "picture", "picture number"),
    *("frame", "frame number", "frame no", "bild", "bildnummer", "bild-nr.", "photo", "file", "filename"),
)

#: In the order in which they are tried: what asks for more comes first.
DIALECTS = (
    ForceDialect(
        name="cellscale_biotester",
        program="CellScale BioTester",
        time=("time",),
        force={"x": ("xforce",), "y": ("yforce",)},
        displacement={"x": ("xdisplacement",), "y": ("ydisplacement",)},
        units="suffix",
        cycles=("setname", "cycle"),
    ),
    ForceDialect(
        name="matchid_image",
        program="MatchID Image.csv",
        time=("timestamp",),
        force={PULL: ("force",)},
        image=("file",),
        units="brackets",
        preamble=0,
    ),
    ForceDialect(
        name="davis_load",
        program="DaVis load record",
        time=("time",),
        force={PULL: ()},
        image=("image index (image index)",),
        also=("image index (image index)",),
        preamble=0,
    ),
    ForceDialect(
        name="davis_channels",
        program="DaVis channels by picture",
        time=(),
        force={PULL: ()},
        image=("index",),
        units="brackets",
        preamble=0,
    ),
    ForceDialect(
        name="mts_testsuite",
        program="MTS TestSuite",
        time=("time", "running time"),
        force={PULL: ("load", "force", "axial force")},
        displacement={PULL: ("crosshead", "extension", "displacement", "axial displacement")},
        begins="file path:",
    ),
    ForceDialect(
        name="zwick_testxpert",
        program="Zwick testXpert",
        time=("prüfzeit", "test time"),
        force={PULL: ("standardkraft", "standard force", "kraft")},
        displacement={PULL: ("standardweg", "traversenweg", "standard travel", "crosshead travel", "weg")},
        delimiters="\t;,",
    ),
    ForceDialect(
        name="bluehill_3",
        program="Instron Bluehill 3",
        time=("time",),
        force={PULL: ("load",)},
        displacement={PULL: ("extension",)},
        also=("extension",),
    ),
    ForceDialect(
        name="bluehill_universal",
        program="Instron Bluehill Universal",
        time=("time",),
        force={PULL: ("force", "load")},
        displacement={PULL: ("displacement", "extension")},
        units="brackets",
    ),
    ForceDialect(
        name="wavematrix",
        program="Instron WaveMatrix",
        time=("total time", "elapsed time", "gesamtzeit", "verstrichene zeit", "temps total", "temps écoulé"),
        force={PULL: ("last(x:kraft)", "load(x:force)", "load(linear:load)", "last(linear:last)")},
        displacement={
            PULL: ("position des aktuators(x:position)", "position(x:position)", "position(linear:position)")
        },
        units="brackets",
        preamble=0,
        delimiters=";,\t",
    ),
    ForceDialect(
        name="cellscale_univert",
        program="CellScale UniVert",
        time=("time",),
        force={PULL: ("force",)},
        displacement={PULL: ("displacement",)},
        units="suffix",
        cycles=("setname", "cycle"),
    ),
    ForceDialect(
        name="named_axes",
        program="columns Time, Force x and Force y",
        time=("time",),
        force={"x": ("force x", "force_x", "fx", "x force"), "y": ("force y", "force_y", "fy", "y force")},
        displacement={"x": ("displacement x", "displacement_x"), "y": ("displacement y", "displacement_y")},
        preamble=0,
    ),
    ForceDialect(
        name="named_axes_brackets",
        program="columns Time, Force x and Force y with units in brackets",
        time=("time",),
        force={"x": ("force x", "force_x", "fx", "x force"), "y": ("force y", "force_y", "fy", "y force")},
        displacement={"x": ("displacement x", "displacement_x"), "y": ("displacement y", "displacement_y")},
        units="brackets",
        preamble=0,
    ),
    ForceDialect(
        name="named_columns",
        program="columns Time and Force",
        time=("time",),
        force={PULL: ("force",)},
        displacement={PULL: ("displacement",)},
        preamble=0,
    ),
    *(
        ForceDialect(
            name=name,
            program=f"a table of usual names with {written}",
            time=time,
            force={PULL: FORCE_NAMES},
            displacement={PULL: WAY_NAMES},
            image=image,
            units=units,
            preamble=30,
            delimiters=",;\t ",
        )
        for usual, time, image in (("usual_names", TIME_NAMES, ()), ("pictures", (), PICTURE_NAMES))
        for name, units, written in (
            (f"{usual}_brackets", "brackets", "units in brackets"),
            (f"{usual}_suffix", "suffix", "units behind a line"),
            (usual, "row", "a line of units"),
        )
    ),
)

#: Factors to s, N, mm and MPa. Case matters: mN is not MN. A column in V holds what no calibration has turned into a
#: force.
TIME_UNITS = {
    **dict.fromkeys(("s", "S", "sec", "Sec", "SEC", "sec.", "Sec.", "secs", "second", "seconds", "Seconds"), 1.0),
    **dict.fromkeys(("Sek", "sek", "Sek.", "Sekunden", "с", "сек", "сек.", "秒"), 1.0),
    "ms": 1e-3, "msec": 1e-3, "мс": 1e-3, "min": 60.0, "min.": 60.0, "minutes": 60.0, "мин": 60.0,
}  # fmt: skip
FORCE_UNITS = {
    "N": 1.0, "n": 1.0, "kN": 1e3, "KN": 1e3, "kn": 1e3, "mN": 1e-3, "mn": 1e-3, "uN": 1e-6, "µN": 1e-6,
    "daN": 10.0, "cN": 0.01, "kgf": 9.80665, "kp": 9.80665, "gf": 9.80665e-3, "lbf": 4.4482216152605,
    "kg": 9.80665, "Kg": 9.80665, "KG": 9.80665, "Kgf": 9.80665, "KGF": 9.80665, "g": 9.80665e-3,
    "lb": 4.4482216152605, "lbs": 4.4482216152605, "LBF": 4.4482216152605, "lbF": 4.4482216152605,
    "Newton": 1.0, "newton": 1.0, "Newtons": 1.0, "newtons": 1.0, "Н": 1.0, "кН": 1e3, "мН": 1e-3, "кгс": 9.80665,
}  # fmt: skip
LENGTH_UNITS = {"mm": 1.0, "um": 1e-3, "µm": 1e-3, "cm": 10.0, "m": 1e3, "мм": 1.0, "in": 25.4, "inch": 25.4}
STRESS_UNITS = {"MPa": 1.0, "N/mm2": 1.0, "N/mm²": 1.0, "N/mm^2": 1.0, "kPa": 1e-3, "Pa": 1e-6, "GPa": 1e3}
VOLTS = ("V", "mV", "v", "mv", "Volt", "volt")
