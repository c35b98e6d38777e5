"""Small exports of every dialect, written as its software does."""

import math

from hypernode.config.specimens import Specimen
from hypernode.dic.dialects import BY_NAME

COLUMNS, ROWS = 6, 5
#: The point that is lost in every deformed frame, by its place in a file whose rows run downward.
LOST = 8
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
DAVIS_8 = '#DaVis 8.1.2 2D-vector 8 6 5 "" "mm" "" "mm" "displacement" "mm"'
STEREO = "x [mm];y [mm];z [mm];X-displacement [mm];Y-displacement [mm];Z-displacement [mm];Angle [°]"


def displacement(k, X, Y):
    """Of frame k, which moves the sheet up and to the right."""
    return k * (0.03 * X + 0.05), k * (0.02 * Y + 0.04)


def turned(x, y, degrees):
    """Components of vectors that are turned counter-clockwise."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return c * x - s * y, s * x + c * y


def points(k, step, y_up, v_up=None, deformed=False, tilt=0.0):
    """x, y, u, v, whether lost, of every point of frame k as a file has them, the sheet turned by a tilt in degrees."""
    for index in range(COLUMNS * ROWS):
        X, Y = step * (index % COLUMNS), step * (ROWS - 1 - index // COLUMNS)
        u, v = turned(*displacement(k, X, Y), tilt)
        X, Y = turned(X, Y, tilt)
        v = v if (y_up if v_up is None else v_up) else -v
        y = Y if y_up else step * (ROWS - 1) - Y
        moved = (u, v) if deformed else (0.0, 0.0)
        yield X + moved[0], y + moved[1], u, v, k > 0 and index == LOST


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
    "davis": (10, DAVIS, zero, ";", ".", "Test{:04d}.csv", 1),
    "davis_mm": (0.5, DAVIS.replace("pixel", "mm"), zero, ";", ".", "Test{:04d}.csv", 1),
    "davis_stereo": (0.5, STEREO, stereo, ";", ".", "B{:04d}.csv", 1),
    "davis8": (0.5, DAVIS_8, zero, "\t", ",", "B{:05d}.txt", 1),
    "matchid_2024": (0.5, MATCHID, matchid, ",", ".", "Image_{:04d}_0.tiff.csv", 0),
    "matchid_2023": (0.5, "x_pic,y_pic,x,y,z,u,v,w,exx,eyy", matchid, ",", ".", "B{:04d}_0.tif.csv", 1),
    "matchid_2d": (10, MATCHID_2D, blank, ",", ".", "Image_{:04d}_0.tiff.csv", 0),
    "vic3d": (0.5, VIC_NAMES, vic, ",", ".", "17_A-4B_sys1-{:04d}_0.csv", 0),
    "vic3d, German": (0.5, VIC_NAMES.replace(",", ";"), vic, ";", ",", "pull-{:04d}_0.csv", 0),
    "vic2d_mm": (0.5, '"x_c","y_c","u_c","v_c","sigma"', vic_2d, ",", ".", "pull-{:04d}_0.csv", 0),
    "vic2d": (10, '"x","y","u","v","sigma"', vic_2d, ",", ".", "pull-{:04d}_0.csv", 0),
    "dice": (
        10, DICE_PREAMBLE + "SUBSET_ID,COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,MATCH",
        lambda x, y, u, v, lost: [7, x, y, u, v, -1 if lost else 0], ",", ".", "DICe_solution_{:02d}.txt", 0,
    ),
    "gom": (
        0.5, GOM + "id;x;y;z;displacement_x;displacement_y;displacement_z;epsilon_x",
        lambda x, y, u, v, lost: None if lost else [1, x, y, 0.5, u, v, 0, 0], ";", ".", "pull_{:d}.555 s.csv", 20,
    ),
    "gom_nodemap": (
        0.5, NODEMAP + "#   ID;  x_undef [mm];  y_undef [mm];  z_undef [mm];  u [mm];  v [mm];  w [mm];  epsx [%]",
        lambda x, y, u, v, lost: None if lost else [1, x, y, 0.5, u, v, 0, 0], ";", ".", "nodemap_{:d}.txt", 1,
    ),
    "pyvale": (
        10, '"subset_x","subset_y","disp_u","disp_v","disp_mag","converged","num_iter",',
        lambda x, y, u, v, lost: [x, y, *(("nan", "nan") if lost else (u, v)), 0, str(not lost), 3, ""],
        ",", ".", "dic_results_im{:04d}.csv", 0,
    ),
    "al_dic": (
        10, "\ufeffnode_id,x_px,y_px,disp_u,disp_v,disp_magnitude",
        lambda x, y, u, v, lost: [0, x, y, *(("nan", "nan") if lost else (u, v)), 0], ",", ".", "frame_{:04d}.csv", 0,
    ),
    "table": (0.5, "x [mm],y [mm],u [mm],v [mm]", blank, ",", ".", "f{:02d}.csv", 1),
}  # fmt: skip


def write(folder, case, change=lambda lines: lines, frames=(0, 1, 2), tilt=0.0):
    """Frames of a dialect; ``change`` is made to the lines of the last. The sheet is tilted by an angle in degrees."""
    step, header, cells, delimiter, decimal, name, first = FRAMES[case]
    dialect = BY_NAME[case.split(",")[0]]
    for k in frames:
        rows = [cells(*p) for p in points(k, step, dialect.y_up, dialect.v_up, dialect.deformed, tilt)]
        lines = [delimiter.join(f"{c}" if isinstance(c, str) else f"{c:.15g}" for c in row) for row in rows if row]
        lines = [line.replace(".", decimal) for line in lines]
        lines = [*header.split("\n"), *(lines if k < frames[-1] else change(lines))]
        path = folder / name.format(first + k)
        path.write_bytes("\r\n".join([*lines, ""]).encode("cp1252" if "°" in header else "utf-8"))
    return path


def specimen(folder, **changes):
    sizes = {"width": 1, "height": 1, "thickness": 1, "frame_rate": 1, "noise_mm": 0.01}
    return Specimen.model_validate({"folder": str(folder), **sizes, **changes})
