"""Which files of a folder are a series, and in which order."""

import pytest

from hypernode.config.loading import ConfigError, check_config
from hypernode.dic.dialects import BY_NAME
from hypernode.dic.errors import DicError
from hypernode.dic.numbering import numbered
from hypernode.dic.reading import read_series, read_test
from tests.dic.exports import specimen, write


def test_pixels_need_their_size_and_millimetres_none(tmp_path, capsys):
    write(tmp_path, "davis")
    with pytest.raises(DicError, match="give pixel_size"):
        read_test(specimen(tmp_path)).millimetres(None)
    assert read_test(specimen(tmp_path)).millimetres(0.25) == 0.25
    for path in tmp_path.iterdir():
        path.unlink()
    write(tmp_path, "davis_mm")
    assert read_test(specimen(tmp_path, pixel_size=0.25)).millimetres(0.25) == 1.0
    assert "pixel_size is ignored" in capsys.readouterr().err
    with pytest.raises(ConfigError, match="give only one of noise_pixels, noise_mm"):
        check_config({
            "specimens": {
                "s": {"folder": "f", "width": 1, "height": 1, "thickness": 1, "noise_mm": 1, "noise_pixels": 1},
            },
            "cases": {"c": {"specimen": "s"}},
        })  # fmt: skip


@pytest.mark.parametrize(
    ("names", "numbers"),
    [
        (["test10001.csv", "test10002.csv", "test10012.csv"], [1, 2, 12]),
        (["Name0099.csv", "Name0100.csv"], [99, 100]),
        (["Image_0000_0.tiff.csv", "Image_0007_0.tiff.csv"], [0, 7]),
        (["pull2024_9.csv", "pull2024_10.csv"], [9, 10]),
        (["DICe_solution_01.txt", "DICe_solution_11.txt"], [1, 11]),
        (["17_A-4B_pull-sys1-0003_0.csv"], [3]),
        ([f"sheet2_step{k:02d}_{load}N.csv" for k, load in enumerate(("0.00", "0.91", "1.13", "10.02"))], [0, 1, 2, 3]),
    ],
)
def test_frames_are_numbered_by_the_digits_that_vary(tmp_path, names, numbers):
    assert sorted(numbered(tmp_path, [tmp_path / name for name in names])) == numbers


@pytest.mark.parametrize("names", [["a1_0001.csv", "a2_0001.csv"], ["t10001.csv", "t20001.csv", "t10002.csv"]])
def test_two_series_of_like_names_are_refused(tmp_path, names):
    with pytest.raises(DicError, match="several series"):
        numbered(tmp_path, [tmp_path / name for name in names])


def test_two_series_in_a_folder_and_a_frame_twice_are_refused(tmp_path):
    write(tmp_path, "davis")
    write(tmp_path, "vic3d")
    with pytest.raises(DicError, match="several series"):
        read_series(tmp_path)
    assert read_series(tmp_path, dialect=BY_NAME["vic3d"]).unit == "mm"
    (tmp_path / "Test01.csv").write_bytes((tmp_path / "Test0001.csv").read_bytes())
    with pytest.raises(DicError, match="frame 1 is there twice"):
        read_series(tmp_path, dialect=BY_NAME["davis"])


def test_times_in_names_give_the_order_and_stay_with_the_frames(tmp_path):
    write(tmp_path, "gom")
    assert [(f.number, f.time) for f in read_series(tmp_path).frames] == [(1, 20.555), (2, 21.555), (3, 22.555)]


def test_time_and_force_of_the_file_stay_with_the_frames(tmp_path):
    write(tmp_path, "matchid_2024")
    assert [(f.time, f.force) for f in read_series(tmp_path).frames] == [(2.5, 0.3)] * 3
