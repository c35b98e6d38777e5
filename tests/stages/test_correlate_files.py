"""Pictures in files become a folder that is read like any other software's."""

import json

import numpy as np
import pytest
from PIL import Image

from hypernode.cli import main
from hypernode.dic.forces.record import read_force_record
from hypernode.dic.reading import read_series
from hypernode.pictures.correlation import Correlated
from hypernode.pictures.errors import PictureError
from hypernode.pictures.files import picture_files, read_pictures, region_mask, seconds_of
from hypernode.stages import correlate_files

TIMES = (438.87, 440.87, 442.87)
PIXEL = 0.01


@pytest.fixture
def folder(tmp_path):
    """Three pictures, the last of which is the least loaded, and a record of two axes."""
    there = tmp_path / "pictures"
    there.mkdir()
    for k, time in enumerate(TIMES):
        Image.fromarray(np.full((200, 240), 10 * k, np.uint8)).save(there / f"skin.{time:010.3f}.png")
    rows = [
        f"Test,1-Recover,{t:.3f},34,7500,7500,{9000 - t:.0f},0,{1000 * (445 - t):.0f},{500 * (445 - t):.0f}"
        for t in np.arange(438, 445, 0.5)
    ]
    head = "SetName,Cycle,Time_S,Temperature,XSize_um,YSize_um,XDisplacement_um,YDisplacement_um,XForce_mN,YForce_mN"
    (there / "record.csv").write_text("\n".join([head, *rows, ""]))
    return there


@pytest.fixture
def engine(monkeypatch):
    """An engine that sees points move to the right and down, a pixel more in every picture, and loses one."""
    asked = {}

    def correlate(pictures, mask, settings, threads):
        asked.update(pictures=pictures, mask=mask, settings=settings)
        lines = np.arange(20, 200, 20)
        row, column = (each.ravel() for each in np.meshgrid(lines, lines, indexing="ij"))
        u = np.zeros((len(pictures), len(row), 2))
        u += np.arange(len(pictures))[:, None, None] * (1.0, 2.0)
        u[-1, 5] = np.nan
        return Correlated(column=column, row=row, displacement=u, correlation=np.ones(u.shape[:2]), step=20)

    monkeypatch.setattr(correlate_files, "correlate", correlate)
    return asked


def command(folder, output, *more):
    words = ["correlate", folder, output, "--pictures", "*.png", "--pixel-size", PIXEL, "--reference", "last"]
    return main([str(word) for word in (*words, *more)])


def test_what_is_written_reads_back_in_mm_upward_from_the_least_loaded_picture(folder, engine, tmp_path, capsys):
    assert command(folder, tmp_path / "out", "--force-file", "record.csv", "--region", 10, 20, 200, 150) == 0
    assert [picture[0, 0] for picture in engine["pictures"]] == [20, 10, 0]
    assert engine["mask"].sum() == 200 * 150 and engine["mask"][20, 10] and not engine["mask"][19, 10]
    series = read_series(tmp_path / "out")
    assert series.unit == "mm" and [frame.time for frame in series.frames] == [0.0, 2.0, 4.0]
    np.testing.assert_allclose(np.diff(series.x), 20 * PIXEL)
    np.testing.assert_allclose(series.frames[1].displacement, np.broadcast_to((PIXEL, -2 * PIXEL), (9, 9, 2)))
    assert np.isnan(series.frames[2].displacement).any(axis=-1).sum() == 1
    said = json.loads((tmp_path / "out" / "correlation.json").read_text())
    assert said["followed"] == [81, 81, 80] and next(iter(said["pictures"])).endswith("442.870.png")
    assert "correlation_window: 0.245" in capsys.readouterr().out


def test_forces_are_those_at_the_pictures_counted_from_the_reference(folder, engine, tmp_path):
    command(folder, tmp_path / "out", "--force-file", "record.csv")
    record = read_force_record(tmp_path / "out" / "force_disp.csv")
    assert record.axes == ("x", "y")
    np.testing.assert_allclose(record.time, [0.0, 2.0, 4.0], atol=1e-9)
    np.testing.assert_allclose(record.force, [[2.13, 1.065], [4.13, 2.065], [6.13, 3.065]])
    np.testing.assert_allclose(record.displacement[:, 0], [0.0, 0.002, 0.004], atol=1e-3)


def test_pictures_outside_the_record_and_a_folder_that_holds_something_are_refused(folder, engine, tmp_path, capsys):
    (folder / "skin.000460.000.png").write_bytes((folder / "skin.000438.870.png").read_bytes())
    assert command(folder, tmp_path / "out", "--force-file", "record.csv") != 0
    assert "438.87 to 460 s, the record holds 438 to 444.5 s" in capsys.readouterr().err
    assert command(folder, folder) != 0
    assert "holds something already" in capsys.readouterr().err


def test_settings_that_an_engine_has_not_are_refused_by_their_option(folder, tmp_path, capsys):
    assert command(folder, tmp_path / "out", "--subset", 20) != 0
    assert "--subset" in capsys.readouterr().err


def test_names_tell_order_and_times(folder):
    assert [path.name[-11:-4] for path in picture_files(folder, "*.png", "last", 2)] == ["442.870", "438.870"]
    assert seconds_of(picture_files(folder, "*.png")).tolist() == list(TIMES)
    assert seconds_of([folder / "a_001.tif"]) is None
    with pytest.raises(PictureError, match="of which every 3 makes 1"):
        picture_files(folder, "*.png", every=3)


def test_pictures_keep_sixteen_bits_and_have_one_size(tmp_path):
    deep = np.arange(600, dtype=np.uint16).reshape(20, 30) * 100
    Image.fromarray(deep).save(tmp_path / "a.tif")
    assert np.array_equal(read_pictures([tmp_path / "a.tif"])[0], deep)
    Image.fromarray(deep[:10]).save(tmp_path / "b.tif")
    with pytest.raises(PictureError, match=r"b\.tif: \(10, 30\)"):
        read_pictures([tmp_path / "a.tif", tmp_path / "b.tif"])
    (tmp_path / "c.tif").write_text("no picture")
    with pytest.raises(PictureError, match="cannot be read"):
        read_pictures([tmp_path / "c.tif"])


def test_a_mask_counts_where_it_is_white_and_a_region_must_fit(tmp_path):
    white = np.zeros((20, 30), np.uint8)
    white[5:10, 5:10] = 255
    Image.fromarray(white).save(tmp_path / "mask.png")
    assert region_mask((20, 30), (0, 0, 8, 8), tmp_path / "mask.png").sum() == 9
    with pytest.raises(PictureError, match="beyond pictures of 30 columns"):
        region_mask((20, 30), (25, 0, 8, 8))
    with pytest.raises(PictureError, match="no pixel"):
        region_mask((20, 30), (20, 0, 5, 5), tmp_path / "mask.png")
