"""Files are written whole or not at all, read back as they were, and damage is found."""

import numpy as np
import pytest

from hypernode.storage.netcdf import SYNTHETIC_UNITS, StorageError, read, sha256, write

GRID = {"X": np.random.default_rng(0).normal(size=(6, 2)), "cells": np.array([[0, 1, 4, 3], [1, 2, 5, 4]])}


def store(path, parents=(), **more):
    write(path, {**GRID, **more}, "a test", {"units": SYNTHETIC_UNITS, "run": {"case": "a"}}, parents)


def test_round_trip_keeps_values_units_and_attributes(tmp_path):
    store(tmp_path / "a.nc")
    back = read(tmp_path / "a.nc")
    np.testing.assert_array_equal(back["X"], GRID["X"])
    assert back["X"].attrs["units"] == "1" and "position" in back["X"].attrs["long_name"]
    assert back.attrs["run"] == '{"case": "a"}'


def test_same_content_gives_the_same_bytes(tmp_path):
    store(tmp_path / "a.nc")
    store(tmp_path / "b.nc")
    assert sha256(tmp_path / "a.nc") == sha256(tmp_path / "b.nc")


def test_an_unknown_variable_or_wrong_dimensions_leave_no_file(tmp_path):
    with pytest.raises(StorageError, match="'velocity' is not in the storage schema"):
        store(tmp_path / "a.nc", velocity=np.zeros(3))
    with pytest.raises(StorageError, match="infinity"):
        store(tmp_path / "a.nc", stretch=np.array([1.0, np.inf]))
    assert list(tmp_path.iterdir()) == []


def test_a_truncated_file_is_named(tmp_path):
    store(tmp_path / "a.nc")
    data = (tmp_path / "a.nc").read_bytes()
    (tmp_path / "a.nc").write_bytes(data[: len(data) // 2])
    with pytest.raises(StorageError, match=r"a\.nc"):
        read(tmp_path / "a.nc")


def test_a_changed_parent_is_found_when_its_child_is_read(tmp_path):
    store(tmp_path / "parent.nc")
    store(tmp_path / "child.nc", parents=[tmp_path / "parent.nc"])
    read(tmp_path / "child.nc")
    data = bytearray((tmp_path / "parent.nc").read_bytes())
    data[len(data) // 2] ^= 1
    (tmp_path / "parent.nc").write_bytes(bytes(data))
    with pytest.raises(StorageError, match=r"parent\.nc is not the file"):
        read(tmp_path / "child.nc")


def test_a_full_disk_leaves_nothing_behind(tmp_path, monkeypatch):
    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("hypernode.storage.netcdf.os.fsync", full)
    with pytest.raises(StorageError, match="No space left on device"):
        store(tmp_path / "a.nc")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_of_results_can_be_moved_and_read_from_anywhere(tmp_path, monkeypatch):
    store(tmp_path / "old/parent.nc")
    store(tmp_path / "old/run/child.nc", parents=[tmp_path / "old/parent.nc"])
    (tmp_path / "old").rename(tmp_path / "new")
    store(tmp_path / "parent.nc", stretch=np.array([1.5]))
    monkeypatch.chdir(tmp_path)
    assert "../parent.nc" in read(tmp_path / "new/run/child.nc").attrs["parents"]


def test_what_a_killed_job_left_of_a_file_goes_when_it_is_written_and_other_files_stay(tmp_path):
    left, other = tmp_path / ".a.nc.1f2e.tmp.nc", tmp_path / ".ba.nc.1f2e.tmp.nc"
    left.touch()
    other.touch()
    store(tmp_path / "a.nc")
    assert sorted(path.name for path in tmp_path.iterdir()) == [other.name, "a.nc", "a.nc.json"]
