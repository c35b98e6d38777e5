"""Series whose files are not one table a frame: a file a subset, a matrix a field, one file for all."""

from collections import Counter
from pathlib import Path

import numpy as np

from hypernode.dic.dialect import Dialect
from hypernode.dic.errors import DicError
from hypernode.dic.folder import MATRIX
from hypernode.dic.header import LENGTHS
from hypernode.dic.numbering import numbered
from hypernode.dic.points import Points, points_from
from hypernode.dic.table import number_in, read_table
from hypernode.dic.text import read_text, refuse_cut_lines
from hypernode.installation import needs


def frames_of_subsets(files: list[Path], dialect: Dialect) -> dict[int, Points]:
    """Frames of files that hold all frames of one point each, in columns that begin with ``FRAME``.

    Raises:
        DicError: a file is broken, or lacks a frame that others have.
    """
    refuse_cut_lines(files)
    rows: dict[int, list[Points]] = {}
    for path in files:
        cells, line, units, preamble = read_table(path, dialect)
        points = points_from(path, cells, line, units, preamble, dialect)
        numbers = cells["FRAME"].tolist()
        for k, number in enumerate(numbers):
            if not number.is_integer():
                raise DicError(f"{path}:{line[k]}: a frame has no number, or half a one: {number:g}")
            if number in numbers[:k]:
                raise DicError(f"{path}:{line[k]}: frame {number:g} is there twice")
            one = slice(k, k + 1)
            each = Points(
                path=path,
                position=points.position[one],
                displacement=points.displacement[one],
                line=points.line[one],
                unit=points.unit,
            )
            rows.setdefault(int(number), []).append(each)
    for number, found in rows.items():
        if len(found) < len(files):
            absent = next(path for path in files if path not in {each.path for each in found})
            raise DicError(f"{absent}: frame {number} is not there, as it is in {found[0].path.name}")
    return {
        number: Points(
            path=found[0].path,
            unit=found[0].unit,
            **{key: np.concatenate([getattr(p, key) for p in found]) for key in ("position", "displacement", "line")},
        )
        for number, found in sorted(rows.items())
    }


def frames_of_stacked(path: Path, dialect: Dialect) -> dict[int, Points]:
    """Frames of one table of all, by the column with their numbers.

    Raises:
        DicError: the table is broken, or a row has no number of a frame.
    """
    cells, line, units, preamble = read_table(path, dialect)
    if dialect.frame not in cells:
        raise DicError(f"{path}: no column {dialect.frame!r} with the number of the frame: correct it, table: frame")
    number = cells[dialect.frame]
    if not (whole := np.isfinite(number) & (number == np.round(number))).all():
        raise DicError(f"{path}:{line[np.argmin(whole)]}: {dialect.frame!r} holds no number of a frame")
    frames = {}
    for each in np.unique(number):
        rows = number == each
        part = {role: values[rows] for role, values in cells.items()}
        frames[int(each)] = points_from(path, part, line[rows], units, preamble, dialect)
    return frames


def frames_of_matrices(files: list[Path], dialect: Dialect) -> dict[int, Points]:
    """Frames of matrices ``NAME_U[mm].csv``, V, X and Y, without header; X and Y are positions in the deformed sheet.

    Raises:
        DicError: a matrix is absent, ragged or of another size than the others.
    """
    refuse_cut_lines(files)
    fields: dict[str, dict[str, Path]] = {}
    for path in files:
        if match := MATRIX.match(path.name):
            fields.setdefault(match["name"], {})[match["field"].upper()] = path
    names = {path: name for name, path in ((name, each.get("U")) for name, each in fields.items()) if path}
    frames = {}
    for number, path in numbered(files[0].parent, list(names)).items():
        one = fields[names[path]]
        for field in ("U", "V", "X", "Y"):
            if field not in one:
                raise DicError(f"{path}: no matrix of {field} beside it: export U, V and the coordinates X and Y")
        matrices = {field: _matrix(one[field], dialect) for field in ("X", "Y", "U", "V")}
        usual, _ = Counter(matrix.shape for matrix in matrices.values()).most_common(1)[0]
        for field, matrix in matrices.items():
            if matrix.shape != usual:
                has, others = (" x ".join(map(str, shape)) for shape in (matrix.shape, usual))
                raise DicError(
                    f"{one[field]}: the matrix has {has} cells, those beside it have {others}: export it again"
                )
        cells = {field.lower(): matrix.ravel() for field, matrix in matrices.items()}
        units = {field.lower(): MATRIX.match(one[field].name)["unit"] for field in matrices}
        line = np.repeat(np.arange(1, matrices["U"].shape[0] + 1), matrices["U"].shape[1])
        frames[number] = points_from(path, cells, line, units, [], dialect)
    return frames


def _matrix(path: Path, dialect: Dialect) -> np.ndarray:
    text, rows = read_text(path), []
    decimal = "," if "," in text else "."
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip():
            continue
        cells = line.split(";")
        if rows and len(cells) == len(rows[0]) + 1 and not cells[-1].strip():
            cells.pop()
        if rows and len(cells) != len(rows[0]):
            raise DicError(f"{path}:{number}: {len(cells)} fields, the first row has {len(rows[0])}")
        rows.append([number_in(cell, decimal, dialect.blanks, f"{path}:{number}", line) for cell in cells])
    if not rows:
        raise DicError(f"{path}:1: the file is empty")
    return np.array(rows)


def frames_of_ncorr(path: Path, dialect: Dialect) -> dict[int, Points]:
    """Frames of an Ncorr file saved by MATLAB 7.3: formatted displacements in the reference, zero outside the region.

    Raises:
        DicError: h5py is not installed, or the file lacks what Ncorr saves.
    """
    try:
        import h5py
    except ImportError:
        raise DicError(f"{path}: is a file of Ncorr, and {needs('h5py')}") from None
    try:
        with h5py.File(path, "r") as file:
            saved = file["data_dic_save"]
            info = saved["dispinfo"]
            spacing, scale = (float(np.ravel(info[key])[0]) for key in ("spacing", "pixtounits"))
            unit = "".join(map(chr, np.ravel(info["units"]))).strip()
            u, v = (_fields(file, saved["displacements"][f"plot_{k}_ref_formatted"]) for k in "uv")
    except (OSError, KeyError, ValueError, TypeError, IndexError) as error:
        raise DicError(f"{path}: not what Ncorr saves as data_dic_save: {error}") from None
    if unit.lower() not in LENGTHS:
        raise DicError(f"{path}: lengths in {unit!r}: analyse again in mm or pixels")
    if len(u) != len(v):
        raise DicError(f"{path}: {len(u)} fields of u and {len(v)} of v: save data_dic_save again")
    if any(each.shape != u[0].shape for each in (*u, *v)):
        raise DicError(f"{path}: fields of different sizes: save data_dic_save again")
    if not (0.0 <= spacing < np.inf and 0.0 < scale < np.inf):
        raise DicError(f"{path}: spacing {spacing:g} and pixtounits {scale:g}: set the units again and save")
    step = (spacing + 1.0) * (scale if LENGTHS[unit.lower()][0] == "mm" else 1.0)
    x, y = np.meshgrid(*(step * np.arange(n) for n in reversed(u[0].shape)))
    line = np.ones(x.size, dtype=int)
    frames = {}
    for number, fields in enumerate(zip(u, v, strict=True), start=1):
        cells = {"x": x.ravel(), "y": y.ravel(), "u": fields[0].ravel(), "v": fields[1].ravel()}
        frames[number] = points_from(path, cells, line, dict.fromkeys("xyuv", unit), [], dialect)
    return frames


def _fields(file, entry) -> list[np.ndarray]:
    """The matrices of a field of a MATLAB structure array, which holds references to them; rows downward."""
    if entry.dtype.kind == "O":
        return [np.array(file[each]).T for each in np.ravel(entry)]
    return [np.array(entry).T]
