"""A corpus of broken inputs: one clear message each, no traceback, nothing left behind."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from hypernode.config.loading import ConfigError, check_config, load_config
from hypernode.dic.dialects import DIALECTS
from hypernode.dic.errors import DicError
from hypernode.dic.forces.record import read_force_record
from hypernode.dic.points import read_points
from hypernode.errors import ExpectedError
from hypernode.stages import import_dic
from hypernode.stages import true_material as truth
from tests.config.test_config import BASE, BROKEN, changed
from tests.dic.test_davis import config as specimen_config
from tests.dic.test_davis import write_frame

ROOT = Path(__file__).resolve().parents[2]

#: Beside those of test_config: (path, value).
MORE_BROKEN = [
    (("geometries", "disc", "radius"), float("nan")),
    (("geometries", "disc", "centre"), [0.5]),
    (("geometries", "disc"), {"shape": "ring", "inner_radius": 0.3, "outer_radius": 0.2}),
    (("geometries", "disc"), {"shape": "glyph", "text": ""}),
    (("geometries", "disc"), "disc"),
    (("geometries",), [1, 2]),
    (("materials", "soft"), {"model": "goh", "C10": 1.0, "k1": 1.0, "k2": 1.0, "kappa": 0.5, "fibre_angle": 0.0}),
    (("materials", "soft"), {}),
    (("loads", "pull", "stretches"), 1.1),
    (("loads", "pull", "stretches"), [0.0]),
    (("noise", "low", "seed"), 1.5),
    (("methods", "m", "hypernetwork", "widths"), []),
    (("methods", "m", "pretraining", "algorithm"), "sgd"),
    (("methods", "m", "node", "share"), 2.0),
    (("cases", "a", "cells"), [0, 5]),
    (("cases", "a", "size"), [1.0]),
    (("cases", "a", "spacing"), [1.0, -1.0]),
    (("cases", "a", "further_phases"), [{"geometry": "disc", "material": "stone"}]),
    (("cases", "a", "camera"), {"cells": [5, 5], "window": -1.0}),
    (("cases", "a", "references"), {"matrix": "b"}),
    (("cases", "a", "references"), {"fibre": "a"}),
    (("grid",), [{"name": "x", "geometry": "disc", "matrix": ["soft", "stiff"], "loads": ["pull"], "methods": ["m"]}]),
    (("grid",), [{"name": "{shape}", "geometry": "disc", "matrix": "soft", "loads": ["pull"], "methods": ["m"]}]),
    (("figures",), {"f": {"kind": "pie", "case": "a", "method": "m"}}),
    (("tables",), {"t": {"kind": "runs", "column": ["Dice"]}}),
]


@pytest.mark.parametrize("number", range(len(BROKEN) + len(MORE_BROKEN)))
def test_a_broken_configuration_has_one_clear_message(number):
    path, value = [entry[:2] for entry in BROKEN + MORE_BROKEN][number]
    with pytest.raises(ConfigError) as found:
        check_config(changed(path, value))
    message = str(found.value)
    assert "Traceback" not in message and len(message) < 2000
    assert str(path[-1]) in message or "case" in message or str(path[0]) in message


def test_the_corpus_of_configurations_is_large_enough():
    assert len(BROKEN) + len(MORE_BROKEN) >= 40


def frame(text):
    return lambda folder: (folder / "Test0011.csv").write_bytes(text.encode() if isinstance(text, str) else text)


def force(text):
    return lambda folder: (folder / "force_disp.csv").write_bytes(text.encode() if isinstance(text, str) else text)


def edited(change):
    def apply(folder):
        path = folder / "Test0011.csv"
        path.write_text("\n".join(change(path.read_text().splitlines())))

    return apply


def place(line):
    """The position of a point in a frame."""
    return ";".join(line.split(";")[:2])


def huge(folder):
    with open(folder / "Test0011.csv", "wb") as file:
        file.truncate(10 * 2**30)


HEADER = "x [pixel];y [pixel];x-displacement [pixel];y-displacement [pixel]"
# fmt: off
BROKEN_FOLDERS = {
    "no frames": lambda folder: [p.unlink() for p in folder.glob("Test*")],
    "no force record": lambda folder: (folder / "force_disp.csv").unlink(),
    "reference frame only": lambda folder: [(folder / f"Test00{n}.csv").unlink() for n in ("06", "11")],
    "empty frame": frame(""),
    "header only": frame(HEADER + "\n"),
    "binary junk": frame(bytes(range(256)) * 20),
    "claims ten gigabytes": huge,
    "wrong delimiter": edited(lambda lines: [line.replace(";", ",") for line in lines]),
    "tabs": edited(lambda lines: [line.replace(";", "\t") for line in lines]),
    "decimal comma": edited(lambda lines: [lines[0], *(line.replace(".", ",") for line in lines[1:])]),
    "a column is missing": edited(lambda lines: [line.rsplit(";", 2)[0] for line in lines]),
    "a renamed column": edited(lambda lines: [lines[0].replace("y-disp", "v-disp"), *lines[1:]]),
    "truncated line": edited(lambda lines: [*lines[:-1], lines[-1][:4]]),
    "word for a number": edited(lambda lines: [*lines[:5], "51;10;n/a;0;0", *lines[6:]]),
    "position not a number": edited(lambda lines: [*lines[:5], "nan;10;0;0;0", *lines[6:]]),
    "duplicate point": edited(lambda lines: [*lines, lines[1]]),
    "point off the grid": edited(lambda lines: [lines[0], "6" + lines[1][1:], *lines[2:]]),
    "all points lost": edited(lambda lines: [lines[0], *(f"{place(x)};0;0;0" for x in lines[1:])]),
    "folded sheet": edited(lambda lines: [lines[0], *(f"{place(x)};0;-{x.split(chr(59))[1]}9;0" for x in lines[1:])]),
    "two series": lambda folder: (folder / "Other0001.csv").write_text(HEADER),
    "a frame twice": lambda folder: (folder / "Test00011.csv").write_text((folder / "Test0011.csv").read_text()),
    "force: empty": force(""),
    "force: no unit row": force("Time,Displacement,Force\n" + "".join(f"{t},0,{t}\n" for t in range(5))),
    "force: unknown unit": force("Time,Force\n(s),(lbf)\n0,1\n9,2\n"),
    "force: time goes back": force("Time,Force\n(s),(N)\n0,1\n9,2\n3,3\n"),
    "force: too short": force("Time,Force\n(s),(N)\n0,1\n0.5,2\n"),
    "force: begins late": force("Time,Force\n(s),(N)\n5,1\n9,2\n"),
    "force: words": force("Time,Force\n(s),(N)\n0,one\n"),
    "force: binary": force(bytes(range(256))),
    "force: not finite": force("Time,Force\n(s),(N)\n0,1\n1.5,inf\n9,3\n"),
}
# fmt: on


@pytest.mark.parametrize("name", BROKEN_FOLDERS)
def test_a_broken_folder_has_one_clear_message_and_leaves_nothing(tmp_path, name):
    folder = tmp_path / "raw"
    folder.mkdir()
    for number, stretch in ((1, 1.0), (6, 1.05), (11, 1.1)):
        write_frame(folder, number, stretch)
    record = ["Time,Displacement,Force", "(s),(mm),(N)"] + [f"{t / 10},0,{t}" for t in range(31)]
    (folder / "force_disp.csv").write_text("\n".join(record))
    BROKEN_FOLDERS[name](folder)
    with pytest.raises((ExpectedError, ValueError)) as found:
        import_dic.run(specimen_config(folder), "c", str(tmp_path / "out/measurement.nc"), {})
    message = str(found.value)
    assert str(folder) in message and "\n" not in message
    assert not list(tmp_path.rglob("*.nc*"))


def test_the_corpus_of_folders_is_large_enough():
    assert len(BROKEN_FOLDERS) >= 25


def test_an_unreadable_mask_and_a_path_outside_end_without_traceback(tmp_path):
    config = yaml.safe_load((ROOT / "config/smoke.yaml").read_text())
    (tmp_path / "mask.png").write_bytes(b"not an image")
    config["geometries"]["disc"] = {"shape": "image", "path": str(tmp_path / "mask.png")}
    (tmp_path / "c.yaml").write_text(yaml.safe_dump(config))
    command = [sys.executable, "-m", "snakemake", "results/disc/true_material.nc", "--cores", "1"]
    command += ["--snakefile", str(ROOT / "Snakefile"), "--directory", str(tmp_path)]
    command += ["--profile", str(ROOT / "profiles/default"), "--configfile", str(tmp_path / "c.yaml")]
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(ROOT / "src")})
    assert done.returncode != 0 and "mask.png: cannot be read as an image" in done.stderr
    assert not list((tmp_path / "results").rglob("*.nc*"))


def test_a_shape_that_lies_in_no_cell_is_refused(tmp_path):
    config = check_config(changed(("geometries", "disc", "radius"), 1e-3))
    with pytest.raises(ValueError, match=r"the geometry 'disc' holds no cell's centre"):
        truth.run(config, "a", str(tmp_path / "true_material.nc"), {})
    assert not list(tmp_path.iterdir())


SCALARS = st.none() | st.booleans() | st.integers(-5, 5) | st.floats(allow_nan=True) | st.text(max_size=6)
VALUES = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=6), inner, max_size=3)
)


@settings(max_examples=150, deadline=None)
@given(st.sampled_from([path for path, *_ in BROKEN] + [(key,) for key in BASE]), VALUES)
def test_any_value_anywhere_is_accepted_or_refused_cleanly(path, value):
    config = changed(path, value) if value is not None else changed(path[:1], None) if path[0] in BASE else BASE
    try:
        check_config(config)
    except ConfigError as error:
        assert "Traceback" not in str(error)


def read_any_dialect(path):
    for dialect in DIALECTS:
        try:
            read_points(path, dialect)
        except DicError as refused:
            assert str(path) in str(refused)


@settings(max_examples=80, deadline=None)
@given(st.binary(max_size=300))
def test_any_bytes_are_read_or_refused_cleanly(tmp_path_factory, content):
    path = tmp_path_factory.mktemp("bytes") / "file.csv"
    path.write_bytes(content)
    for reader, error in ((read_any_dialect, DicError), (read_force_record, DicError), (load_config, ConfigError)):
        try:
            reader(path)
        except error as refused:
            assert str(path) in str(refused)
