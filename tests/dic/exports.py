"""Small exports of every dialect, written as its software does."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from hypernode.config.specimens import Specimen
from hypernode.dic.dialects import BY_NAME

COLUMNS, ROWS = 6, 5
#: The point that is lost in every deformed frame, by its place in a file whose rows run downward.
LOST = 8
#: Steps between the points of exports in pixels and in mm.
PIXELS, MM = 10, 0.5
VIC_NAMES = ' "X",  "Y",  "Z",  "U",  "V",  "W",  "exx",  "sigma",  "x",  "y",  "u",  "v"'
DICE_PREAMBLE = "***\n*** Incremental correlation: false\n*** y positive down\n***\n"
GOM = "# Units: length:mm angle:deg time:s\n# stage;index;relative_time;date\n# 1;0;0.0;today\n"
NODEMAP = "# A test\n# force                : analog_input        : 12.5\n#####\n"
MATCHID = (
    "Coordinates.Image X [Pixel],Coordinates.Image Y [Pixel],coor.X [mm],coor.Y [mm],coor.Z [mm],"
    "disp.Horizontal Displacement U [mm],disp.Vertical Displacement V [mm],disp.Out-Of-Plane: W [mm],"
    "ext.Time [s],ext.Force [N]"
)
MATCHID_2D = (
    "Coordinates.Image X [Pixel],Coordinates.Image Y [Pixel],disp.Horizontal Displacement U [Pixel],"
    "disp.Vertical Displacement V [Pixel]"
)
DAVIS = "x [pixel];y [pixel];x-displacement [pixel];y-displacement [pixel]"
DAVIS_8 = '#DaVis 8.1.2 2D-vector 8 {columns} {rows} "" "mm" "" "mm" "displacement" "mm"'
STEREO = "x [mm];y [mm];z [mm];X-displacement [mm];Y-displacement [mm];Z-displacement [mm];Angle [°]"


def displacement(k, X, Y):
    """Of frame k, which moves the sheet up and to the right."""
    return k * (0.03 * X + 0.05), k * (0.02 * Y + 0.04)


def turned(x, y, degrees):
    """Components of vectors that are turned counter-clockwise."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return c * x - s * y, s * x + c * y


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """What is exported: a grid of points, how each frame displaces it, which point is lost, digits of numbers.

    The sheet is turned by a tilt in degrees.
    """

    columns: int = COLUMNS
    rows: int = ROWS
    displacement: Callable = displacement
    lost: int = LOST
    digits: int = 15
    tilt: float = 0.0

    def written(self, value) -> str:
        return value if isinstance(value, str) else f"{value:.{self.digits}g}"


SMALL = Sheet()


def points(k, step, y_up, v_up=None, deformed=False, sheet=SMALL):
    """x, y, u, v, whether lost, of every point of frame k as a file has them."""
    for index in range(sheet.columns * sheet.rows):
        X, Y = step * (index % sheet.columns), step * (sheet.rows - 1 - index // sheet.columns)
        u, v = turned(*sheet.displacement(k, X, Y), sheet.tilt)
        X, Y = turned(X, Y, sheet.tilt)
        v = v if (y_up if v_up is None else v_up) else -v
        y = Y if y_up else step * (sheet.rows - 1) - Y
        moved = (u, v) if deformed else (0.0, 0.0)
        yield X + moved[0], y + moved[1], u, v, k > 0 and index == sheet.lost


def zero(x, y, u, v, lost):
    return [x, y, *((0, 0) if lost else (u, v))]


def stereo(x, y, u, v, lost):
    return None if lost else [x, y, 0.5, u, v, 0.001, 1]


def matchid(x, y, u, v, lost):
    return [1000 * x, 1000 * y, x, y, 0.5, *(("", "") if lost else (u, v)), 0.001, 2.5, 0.3]


def vic(x, y, u, v, lost):
    return [-9.1, -7.4, 410.0, 0, 0, 0, 0, -1, 2, 3, 0, 0] if lost else [x, y, 0.5, u, v, 0, 0, 0.01, 2, 3, 0, 0]


def vic_2d(x, y, u, v, lost):
    return [-9.1, -7.4, 0, 0, -1] if lost else [x, y, u, v, 0.01]


def blank(x, y, u, v, lost):
    return [x, y, *(("nan", "nan") if lost else (u, v))]


#: Dialect -> (step, header, cells of a point, delimiter, decimal sign, name of a file, number of the first frame).
FRAMES = {
    "davis": (PIXELS, DAVIS, zero, ";", ".", "Test{:04d}.csv", 1),
    "davis_mm": (MM, DAVIS.replace("pixel", "mm"), zero, ";", ".", "Test{:04d}.csv", 1),
    "davis_stereo": (MM, STEREO, stereo, ";", ".", "B{:04d}.csv", 1),
    "davis8": (MM, DAVIS_8, zero, "\t", ",", "B{:05d}.txt", 1),
    "matchid_2024": (MM, MATCHID, matchid, ",", ".", "Image_{:04d}_0.tiff.csv", 0),
    "matchid_2023": (MM, "x_pic,y_pic,x,y,z,u,v,w,exx,eyy", matchid, ",", ".", "B{:04d}_0.tif.csv", 1),
    "matchid_2d": (PIXELS, MATCHID_2D, blank, ",", ".", "Image_{:04d}_0.tiff.csv", 0),
    "vic3d": (MM, VIC_NAMES, vic, ",", ".", "17_A-4B_sys1-{:04d}_0.csv", 0),
    "vic3d, German": (MM, VIC_NAMES.replace(",", ";"), vic, ";", ",", "pull-{:04d}_0.csv", 0),
    "vic2d_mm": (MM, '"x_c","y_c","u_c","v_c","sigma"', vic_2d, ",", ".", "pull-{:04d}_0.csv", 0),
    "vic2d": (PIXELS, '"x","y","u","v","sigma"', vic_2d, ",", ".", "pull-{:04d}_0.csv", 0),
    "dice": (
        PIXELS, DICE_PREAMBLE + "SUBSET_ID,COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,MATCH",
        lambda x, y, u, v, lost: [7, x, y, u, v, -1 if lost else 0], ",", ".", "DICe_solution_{:02d}.txt", 0,
    ),
    "gom": (
        MM, GOM + "id;x;y;z;displacement_x;displacement_y;displacement_z;epsilon_x",
        lambda x, y, u, v, lost: None if lost else [1, x, y, 0.5, u, v, 0, 0], ";", ".", "pull_{:d}.555 s.csv", 20,
    ),
    "gom_nodemap": (
        MM, NODEMAP + "#   ID;  x_undef [mm];  y_undef [mm];  z_undef [mm];  u [mm];  v [mm];  w [mm];  epsx [%]",
        lambda x, y, u, v, lost: None if lost else [1, x, y, 0.5, u, v, 0, 0], ";", ".", "nodemap_{:d}.txt", 1,
    ),
    "pyvale": (
        PIXELS, '"subset_x","subset_y","disp_u","disp_v","disp_mag","converged","num_iter",',
        lambda x, y, u, v, lost: [x, y, *(("nan", "nan") if lost else (u, v)), 0, str(not lost), 3, ""],
        ",", ".", "dic_results_im{:04d}.csv", 0,
    ),
    "al_dic": (
        PIXELS, "\ufeffnode_id,x_px,y_px,disp_u,disp_v,disp_magnitude",
        lambda x, y, u, v, lost: [0, x, y, *(("nan", "nan") if lost else (u, v)), 0], ",", ".", "frame_{:04d}.csv", 0,
    ),
    "table": (MM, "x [mm],y [mm],u [mm],v [mm]", blank, ",", ".", "f{:02d}.csv", 1),
}  # fmt: skip


def write(folder, case, change=lambda lines: lines, frames=(0, 1, 2), tilt=0.0, sheet=SMALL):
    """Frames of a dialect; ``change`` is made to the lines of the last. The sheet is tilted by an angle in degrees."""
    step, header, cells, delimiter, decimal, name, first = FRAMES[case]
    header = header.replace("{columns}", str(sheet.columns)).replace("{rows}", str(sheet.rows))
    dialect = BY_NAME[case.split(",")[0]]
    for k in frames:
        tilted = replace(sheet, tilt=tilt) if tilt else sheet
        rows = [cells(*p) for p in points(k, step, dialect.y_up, dialect.v_up, dialect.deformed, tilted)]
        lines = [delimiter.join(map(sheet.written, row)).replace(".", decimal) for row in rows if row]
        lines = [*header.split("\n"), *(lines if k < frames[-1] else change(lines))]
        path = folder / name.format(first + k)
        path.write_bytes("\r\n".join([*lines, ""]).encode("cp1252" if "°" in header else "utf-8"))
    return path


def subsets(folder, frames=(0, 1, 2), sheet=SMALL):
    """One file for each point, with a row for each frame."""
    header = "FRAME COORDINATE_X COORDINATE_Y DISPLACEMENT_X DISPLACEMENT_Y SIGMA"
    tables = [list(points(k, PIXELS, y_up=False, sheet=sheet)) for k in frames]
    for index in range(sheet.columns * sheet.rows):
        cells = [(k, *table[index][:4], -1 if table[index][4] else 0.1) for k, table in enumerate(tables)]
        rows = [" ".join(map(sheet.written, row)) for row in cells]
        (folder / f"DICe_solution_{index}.txt").write_text("\n".join([DICE_PREAMBLE + header, *rows, ""]))


def matrices(folder, sheet=SMALL):
    """One file for each field of each frame, with a decimal comma and Italian words for what is no number."""
    for k in range(3):
        table = [p[:4] for p in points(k, MM, y_up=False, deformed=True, sheet=sheet)]
        cells = np.array(table).reshape(sheet.rows, sheet.columns, 4)
        for j, field in enumerate("XYUV"):
            text = [[sheet.written(value).replace(".", ",") for value in row] for row in cells[..., j]]
            if k and field in "UV":
                text[sheet.lost // sheet.columns][sheet.lost % sheet.columns] = "Non un numero reale"
            (folder / f"Image_{k:04d}_0.tif_{field}[mm].csv").write_text("\n".join([*map(";".join, text), ""]))


def ncorr(folder, sheet=SMALL):
    """A structure array as MATLAB 7.3 saves it, of millimetres."""
    h5py = pytest.importorskip("h5py", reason="h5py is not installed: Ncorr files cannot be written")
    tables = [[zero(*p)[2:] for p in points(k, MM, y_up=False, sheet=sheet)] for k in (1, 2)]
    fields = [np.array(table).reshape(sheet.rows, sheet.columns, 2) for table in tables]
    path = folder / "result.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        saved = file.create_group("data_dic_save")
        for key, value in {"spacing": [[4.0]], "pixtounits": [[MM / 5.0]], "units": [[ord(c)] for c in "mm"]}.items():
            saved[f"dispinfo/{key}"] = np.array(value)
        for j, name in enumerate("uv"):
            references = []
            for k, each in enumerate(fields):
                file[f"#refs#/{name}{k}"] = each[..., j].T
                references.append([file[f"#refs#/{name}{k}"].ref])
            saved.create_dataset(f"displacements/plot_{name}_ref_formatted", data=references, dtype=h5py.ref_dtype)
    with open(path, "r+b") as handle:
        handle.write(b"MATLAB 7.3 MAT-file, Platform: any")


#: Dialects that are no table a frame -> (writer, step).
ASSEMBLED = {"dice_subsets": (subsets, PIXELS), "matchid_matrices": (matrices, MM), "ncorr": (ncorr, MM)}


def export(folder, case, sheet=SMALL):
    """Three frames of any dialect; the step between their points."""
    if case in ASSEMBLED:
        writer, step = ASSEMBLED[case]
        writer(folder, sheet=sheet)
        return step
    write(folder, case, sheet=sheet)
    return FRAMES[case][0]


def specimen(folder, **changes):
    sizes = {"width": 1, "height": 1, "thickness": 1, "frame_rate": 1, "noise_mm": 0.01}
    return Specimen.model_validate({"folder": str(folder), **sizes, **changes})
