"""A broken file of a series that is no table a frame is refused with its name, its line and what is wrong with it."""

import numpy as np
import pytest

from hypernode.dic.reading import read_series
from tests.dic.exports import export
from tests.dic.refusals import refused

#: Where Ncorr keeps units and displacements.
INFO, FIELDS = "data_dic_save/dispinfo", "data_dic_save/displacements/plot_v_ref_formatted"


def subset(folder):
    export(folder, "dice_subsets")
    return folder / "DICe_solution_7.txt"


def matrix(field):
    def written(folder):
        export(folder, "matchid_matrices")
        return folder / f"Image_0002_0.tif_{field}[mm].csv"

    return written


def matlab(folder):
    export(folder, "ncorr")
    return folder / "result.mat"


def lines(change):
    def apply(path):
        path.write_text("\n".join([*change(path.read_text().splitlines()), ""]))

    return apply


def dataset(name, change):
    """A change to a data set of a MATLAB file, which is deleted where the change gives none."""

    def apply(path):
        h5py = pytest.importorskip("h5py")
        with h5py.File(path, "r+") as file:
            values = file[name][()]
            del file[name]
            if (changed := change(values)) is not None:
                file[name] = changed

    return apply


#: Name -> (file that is broken, how, what is said, whether a line is named).
FAULTS = {
    "subset: a frame twice": (subset, lines(lambda rows: [*rows, rows[-1]]), "frame 2 is there twice", True),
    "subset: a frame without number": (
        subset, lines(lambda rows: [*rows[:-1], "nan" + rows[-1][1:]]), "a frame has no number", True,
    ),
    "subset: a frame of half a number": (
        subset, lines(lambda rows: [*rows[:-1], "1.5" + rows[-1][1:]]), "a frame has no number", True,
    ),
    "subset: a frame less": (subset, lines(lambda rows: rows[:-1]), "frame 2 is not there, as it is in", False),
    "subset: a word": (subset, lines(lambda rows: [*rows[:-1], rows[-1].replace(" ", " x", 1)]), "not a number", True),
    "subset: cut": (subset, lambda path: path.write_bytes(path.read_bytes()[:-3]), "the file is cut off", True),
    "subset: empty": (subset, lambda path: path.write_bytes(b""), "the file is empty", True),
    "subset: only a header": (subset, lines(lambda rows: rows[:-3]), "no points", True),
    "subset: increments": (
        subset, lines(lambda rows: [row.replace("false", "true") for row in rows]), "from frame to frame", True,
    ),
    "matrix: a word": (
        matrix("U"), lines(lambda rows: [*rows[:2], rows[2].replace("0", "o"), *rows[3:]]), "not a number", True,
    ),
    "matrix: decimal points and commas": (
        matrix("U"), lines(lambda rows: [*rows[:-1], rows[-1].replace(",", ".")]), "a decimal point among", True,
    ),
    "matrix: a row less": (
        matrix("V"), lines(lambda rows: rows[:-1]), "4 x 6 cells, those beside it have 5 x 6", False,
    ),
    "matrix: cut": (matrix("V"), lambda path: path.write_bytes(path.read_bytes()[:-2]), "the file is cut off", True),
    "matrix: cut within a row": (
        matrix("V"), lambda path: path.write_bytes(path.read_bytes()[:-30]), "the file is cut off", True,
    ),
    "matrix: tabs": (
        matrix("X"), lines(lambda rows: [row.replace(";", "\t") for row in rows]), "not a number", True,
    ),
    "matrix: empty": (matrix("Y"), lambda path: path.write_bytes(b""), "the file is empty", True),
    "matrix: zero bytes": (matrix("Y"), lambda path: path.write_bytes(bytes(99)), "it holds zero bytes", False),
    "matlab: cut": (matlab, lambda path: path.write_bytes(path.read_bytes()[:2000]), "not what Ncorr saves", False),
    "matlab: no units": (matlab, dataset(f"{INFO}/units", lambda _: None), "not what Ncorr saves", False),
    "matlab: feet": (
        matlab, dataset(f"{INFO}/units", lambda _: np.array([[ord(c)] for c in "foot"])), "lengths in 'foot'", False,
    ),
    "matlab: a text for the spacing": (
        matlab, dataset(f"{INFO}/spacing", lambda _: "four"), "not what Ncorr saves", False,
    ),
    "matlab: no spacing": (
        matlab, dataset(f"{INFO}/pixtounits", lambda _: np.array([[np.nan]])), "spacing", False,
    ),
    "matlab: a field of another size": (
        matlab, dataset("#refs#/u1", lambda values: values[:-1]), "fields of different sizes", False,
    ),
    "matlab: a field less": (
        matlab, dataset(FIELDS, lambda _: None), "not what Ncorr", False,
    ),
    "matlab: fewer of one component": (
        matlab, dataset(FIELDS, lambda values: values[:1]),
        "2 fields of u and 1 of v", False,
    ),
    "matlab: numbers in lists": (
        matlab, dataset("#refs#/u1", lambda values: values.ravel()), "not what Ncorr saves|fields of different", False,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_a_broken_file_of_several_frames_or_fields_is_refused_with_its_reason(tmp_path, name):
    written, fault, words, line = FAULTS[name]
    path = written(tmp_path)
    fault(path)
    with refused(path, words, line):
        read_series(tmp_path)
