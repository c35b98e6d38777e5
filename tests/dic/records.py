"""Force records of every program, written as it does."""

from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass


@dataclass(frozen=True)
class Record:
    """How one program writes a sample.

    Attributes:
        head: lines above the samples; the last two, or one, are names and units.
        cells: of the sample of a number, time [s], crosshead [mm] and force [N].
        delimiter, decimal: between and in cells.
        quoted: whether cells stand in quotes.
        units: number of lines below the names that hold units.
        time, force: places of their cells; None where there is none.
    """

    head: str
    cells: Callable
    force: int
    _: KW_ONLY
    time: int | None = 0
    delimiter: str = ","
    decimal: str = "."
    quoted: bool = False
    units: int = 1

    def line(self, k, t, d, f) -> str:
        texts = [c if isinstance(c, str) else f"{c:.12g}".replace(".", self.decimal) for c in self.cells(k, t, d, f)]
        return self.delimiter.join(f'"{cell}"' if self.quoted else cell for cell in texts)


RECORDS = {
    "named_columns": Record("Time,Displacement,Force\n(s),(mm),(N)", lambda k, t, d, f: [t, d, f], 2, quoted=True),
    "named_axes": Record(
        "Time,Displacement x,Displacement y,Force x,Force y\n(s),(mm),(mm),(N),(N)",
        lambda k, t, d, f: [t, d, 0.5 * d, f, 0.2 * f + 0.4],
        3,
    ),
    "named_axes_brackets": Record(
        "Time (s),Displacement x (mm),Displacement y (mm),Force x (N),Force y (N)",
        lambda k, t, d, f: [t, d, 0.5 * d, f, 0.2 * f + 0.4],
        3,
        units=0,
    ),
    "bluehill_3": Record(
        'Specimen label : "A",\nRate : 24.0,mm/min\n\n'
        '"Results Table 1"\n"Time","Extension","Load"\n"(s)","(mm)","(kN)"',
        lambda k, t, d, f: [t, d, f / 1e3],
        2,
        quoted=True,
    ),
    "bluehill_universal": Record(
        'Results Table\n,"Maximum Force (kN)"\n1,"1,234.5"\n\nRaw Data\nTime (s),Displacement (mm),Force (N)',
        lambda k, t, d, f: [t, d, f],
        2,
        units=0,
    ),
    "zwick_testxpert": Record(
        '"Probendicke"\t1,55\t"mm"\n"Prüfgeschwindigkeit"\t24\t"mm/min"\n\n'
        '"Prüfzeit"\t"Standardweg"\t"Standardkraft"\n"s"\t"mm"\t"N"',
        lambda k, t, d, f: [t, d, f],
        2,
        delimiter="\t",
        decimal=",",
    ),
    "mts_testsuite": Record(
        'File Path:,C:\\tests\\a\nTest:,pull\n\n\n"Time ","Crosshead ","Load "\n"sec","mm","kN"',
        lambda k, t, d, f: [t, d, f / 1e3],
        2,
    ),
    "wavematrix": Record(
        '"Gesamtzeit (s)";"Gesamtzyklen";"Position des Aktuators(X:Position) (mm)";"Last(X:Kraft) (kN)";',
        lambda k, t, d, f: [t, 1, d, f / 1e3, ""],
        3,
        delimiter=";",
        decimal=",",
        units=0,
    ),
    "cellscale_univert": Record(
        "SetName,Cycle,Time_S,Size_mm,Displacement_mm,Force_N",
        lambda k, t, d, f: ["Ramp", "1-Stretch", t, 20 + d, d, f],
        5,
        time=2,
        units=0,
    ),
    "usual_names": Record(
        "Machine;A\n\nZeit;Traversenweg;Kraft\ns;mm;N", lambda k, t, d, f: [t, d, f], 2, delimiter=";", decimal=","
    ),
    "usual_names_brackets": Record(
        "Elapsed Time [s],Stroke [mm],Load [kN]", lambda k, t, d, f: [t, d, f / 1e3], 2, units=0
    ),
    "usual_names_suffix": Record("t_s,position_mm,load_N", lambda k, t, d, f: [t, d, f], 2, units=0),
    "pictures": Record(
        "Bild;Weg;Kraft\n;mm;N", lambda k, t, d, f: [k + 1, d, f], 2, time=None, delimiter=";", decimal=","
    ),
    "pictures_brackets": Record(
        "Image,Stroke [mm],Load [kN]", lambda k, t, d, f: [k + 1, d, f / 1e3], 2, time=None, units=0
    ),
    "pictures_suffix": Record("frame,position_mm,load_N", lambda k, t, d, f: [k + 1, d, f], 2, time=None, units=0),
    "cellscale_biotester": Record(
        "SetName,Cycle,Time_S,Temperature,XSize_um,YSize_um,XDisplacement_um,YDisplacement_um,XForce_mN,YForce_mN",
        lambda k, t, d, f: [
            "Pull",
            "1-Stretch",
            t,
            34,
            7500 + 1e3 * d,
            7500 + 500 * d,
            1e3 * d,
            500 * d,
            1e3 * f,
            200 * f + 400,
        ],
        8,
        time=2,
        units=0,
    ),
    "davis_load": Record(
        "Time;Image index (Image index);Strain (Extensometer);kilo Newton ADC channel 1\nms;;S;kN",
        lambda k, t, d, f: [1e3 * t, "" if k % 2 else f"{1 + k // 2}.000000", 0, f / 1e3],
        3,
        delimiter=";",
    ),
    "davis_channels": Record(
        "Index;ADC 1 channel 1 [N];Exposure time []",
        lambda k, t, d, f: [k + 1, f, 50],
        1,
        time=None,
        delimiter=";",
        units=0,
    ),
    "matchid_image": Record(
        "File;TimeStamp;Force [V]; Force [N]",
        lambda k, t, d, f: [f"C:\\a\\Image_{k:04d}_0.tiff", t, f / 250.0, f],
        3,
        time=1,
        delimiter=";",
        units=0,
    ),
}


def text(name: str, time, displacement, force) -> str:
    """A record of samples [s, mm, N]; of the biaxial machine they are those along x."""
    record = RECORDS[name]
    samples = zip(time, displacement, force, strict=True)
    return "\n".join([record.head, *(record.line(k, *sample) for k, sample in enumerate(samples)), ""])
