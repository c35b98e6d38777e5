"""Records of every known program are read to s, N and mm, and what can be read in two ways is refused."""

from typing import get_args

import numpy as np
import pytest

from hypernode.config.specimen_tests import ForceFormat
from hypernode.dic.errors import DicError
from hypernode.dic.forces.dialects import DIALECTS
from hypernode.dic.forces.matching import pull_record
from hypernode.dic.forces.record import read_force_record
from hypernode.dic.frame_clock import FrameClock
from tests.dic.records import RECORDS, text

# Every file below holds the same pull: 1.5 and 2.5 N at 0 and 0.5 s, the crosshead, if recorded, at 0 and 0.2 mm.
FILES = {name: text(name, [0.0, 0.5], [0.0, 0.2], [1.5, 2.5]) for name in RECORDS}
PLAIN = FILES["named_columns"]


def record(tmp_path, written, encoding="utf-8", **choice):
    (tmp_path / "force.csv").write_bytes(written.encode(encoding))
    return read_force_record(tmp_path / "force.csv", **choice)


def test_the_configuration_knows_every_dialect_and_each_is_tested():
    names = {dialect.name for dialect in DIALECTS}
    assert set(get_args(ForceFormat)) == names == set(FILES)


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize(
    ("encoding", "told"), [("utf-8", True), ("utf-8-sig", False), ("latin-1", False), ("utf-16", False)]
)
def test_a_record_of_each_program_is_recognised_and_read_in_s_n_and_mm(tmp_path, name, encoding, told):
    read = record(tmp_path, FILES[name], encoding, dialect=name if told else None)
    assert read.dialect.name == name
    np.testing.assert_allclose(read.force[:, read.column("x")], [1.5, 2.5])
    if read.time is not None:
        np.testing.assert_allclose(read.time, [0.0, 0.5])
    if read.displacement is not None:
        np.testing.assert_allclose(read.displacement[:, read.column("x")], [0.0, 0.2])
    assert (read.displacement is not None) == bool(read.dialect.displacement)


def test_each_axis_of_a_biaxial_machine_has_its_own_force(tmp_path):
    read = record(tmp_path, FILES["cellscale_biotester"])
    assert read.axes == ("x", "y")
    np.testing.assert_allclose(read.force[:, read.column("y")], [0.7, 0.9])


def test_a_cycle_is_chosen_by_its_names_and_otherwise_they_are_listed(tmp_path):
    longer = FILES["cellscale_biotester"] + "Pull,1-Recover,0.7,34,7700,7600,200,100,800,600\n"
    read = record(tmp_path, longer, set_name="Pull", cycle="1-Recover")
    np.testing.assert_allclose(read.force, [[0.8, 0.6]])
    with pytest.raises(DicError, match="choose one of Pull: 1-Stretch, 1-Recover"):
        record(tmp_path, longer)


def test_a_channel_of_another_name_is_used_where_it_is_named(tmp_path):
    two = "Time,Force,Small cell\n(s),(N),(mN)\n0,1,1500\n1,2,2500\n"
    read = record(tmp_path, two, channel="small cell")
    np.testing.assert_allclose(read.force[:, 0], [1.5, 2.5])
    assert read.channels == ("Small cell",)
    with pytest.raises(DicError, match=r"csv:1: no columns 'Large cell' among .*set force_channel"):
        record(tmp_path, two, channel="Large cell")


def test_two_axes_of_named_columns_are_a_biaxial_machine(tmp_path):
    two = "Time,Displacement x,Displacement y,Force x,Force y\n(s),(mm),(um),(N),(mN)\n0,0,0,1,1500\n1,0.1,200,2,2500\n"
    read = record(tmp_path, two)
    assert read.axes == ("x", "y") and read.channels == ("Force x", "Force y")
    np.testing.assert_allclose(read.force, [[1.0, 1.5], [2.0, 2.5]])
    np.testing.assert_allclose(read.displacement, [[0.0, 0.0], [0.1, 0.2]])
    np.testing.assert_allclose(record(tmp_path, two, channel="Force y").force, [[1.5], [2.5]])


@pytest.mark.parametrize("rows", ["0,000;1.234,5\n0,500;2.000,5", "0.0;1,234.5\n0.5;2,000.5", "0.0;1234.5\n0.5;2000.5"])
def test_decimal_commas_and_thousands_are_told_apart(tmp_path, rows):
    read = record(tmp_path, f"Time;Force\n(s);(N)\n{rows}\n")
    np.testing.assert_array_equal(read.time, [0.0, 0.5])
    np.testing.assert_array_equal(read.force[:, 0], [1234.5, 2000.5])


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ("Time;Force\n(s);(N)\n1;1,234\n2;2,345\n", r"csv:3: '1,234' may have a decimal comma or thousands"),
        (
            "Time;Force\n(s);(N)\n0.25;1,5\n0.5;2,5\n",
            r"csv:3: '0.25' has a decimal point and '1,5' in line 3 a decimal",
        ),
        ("Time,Force\n(s),(V)\n0,0.1\n1,0.2\n", r"csv:2: 'Force' is in volts"),
        ("Time,Force\n(s),(MN)\n0,0.1\n1,0.2\n", r"csv:2: .*force in \(N\), found 'MN'"),
        ("Index;Cell [N]\n1;0.1\n;0.2\n", r"csv:3: neither a time nor the number of a picture"),
        ("Index;ADC 1 channel 1 [V]\n1;0.1\n2;0.2\n", r"csv:1: 'ADC 1 channel 1 \[V\]' is in volts"),
        (
            "File;TimeStamp;Force [V]; Force [N]\na_0000_0.tif;0;0.1;0.1\na_0001_0.tif;1;0.2;0.2\n",
            r"csv:1: 'Force \[N\]' repeats the volts of 'Force \[V\]'",
        ),
    ],
)
def test_what_can_be_read_in_two_ways_or_is_no_force_is_refused_with_its_line(tmp_path, written, message):
    with pytest.raises(DicError, match=message):
        record(tmp_path, written)


def test_a_program_that_is_named_and_did_not_write_the_file_is_an_error(tmp_path):
    with pytest.raises(DicError, match="Instron Bluehill 3"):
        record(tmp_path, PLAIN, dialect="bluehill_3")


def pull(read, **changes):
    clock = FrameClock(np.array([1.0, 2.0]), np.array([0.0, 0.5]))
    return pull_record(read, **{"axis": "x", "force_offset": 0.0, "clock": clock, **changes})


def test_forces_are_those_of_the_picture_where_pictures_are_numbered_and_their_mean_where_one_is_repeated(tmp_path):
    rows = ["0;1;9;1", "1000;;9;50", "2000;2;9;3", "3000;2;9;5"]
    written = "Time;Image index (Image index);Strain;Load cell\nms;;S;N\n" + "\n".join(rows) + "\n"
    matched = pull(record(tmp_path, written))
    np.testing.assert_array_equal(matched.forces(np.array([1, 2])), [1.0, 4.0])
    np.testing.assert_array_equal(matched.times(np.array([1, 2])), [0.0, 2.5])
    with pytest.raises(DicError, match="no sample of picture 3; it has 1 to 2"):
        matched.forces(np.array([3]))


def test_samples_of_one_time_are_averaged_and_nothing_is_extrapolated(tmp_path):
    matched = pull(record(tmp_path, "Time,Force\n(s),(N)\n0,0\n1,2\n1,4\n2,6\n"))
    np.testing.assert_allclose(matched.forces(np.array([1, 3, 4])), [0.0, 3.0, 4.5])
    with pytest.raises(DicError, match="ends at 2 s, before frame 6"):
        matched.forces(np.array([6]))
    with pytest.raises(DicError, match="begins at 1 s, after frame 1 at 0 s: set first_frame_time"):
        pull(record(tmp_path, "Time,Force\n(s),(N)\n1,0\n2,2\n")).forces(np.array([1]))


@pytest.mark.parametrize("end", ["", "\n"])
def test_a_whole_number_at_the_end_of_two_samples_is_believed_where_its_line_ends(tmp_path, end):
    path = tmp_path / "record.csv"
    path.write_text("Time (s),Displacement (mm),Force (mN)\n0,0,0\n1,62,1" + end)
    if end:
        assert read_force_record(path).force[1, 0] == pytest.approx(1e-3)
        return
    with pytest.raises(DicError, match=r"record.csv:3: the last line has no end.*cut off"):
        read_force_record(path)
