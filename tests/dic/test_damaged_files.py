"""Damage of any kind ends in one sentence or in numbers: never in another error, never in an infinity."""

import zlib

import numpy as np
import pytest

from hypernode.dic.errors import DicError
from hypernode.dic.forces.record import read_force_record
from hypernode.dic.reading import read_series
from tests.dic.exports import ASSEMBLED, FRAMES, export
from tests.dic.mutations import mutated
from tests.dic.records import RECORDS, text
from tests.dic.refusals import contents


@pytest.mark.parametrize("case", [*FRAMES, *ASSEMBLED])
def test_a_damaged_export_is_refused_or_read_as_finite_numbers_and_lost_points(tmp_path, case):
    random = np.random.default_rng(zlib.crc32(case.encode()))
    export(tmp_path, case)
    paths = sorted(tmp_path.iterdir())
    for _ in range(30):
        path = paths[random.integers(len(paths))]
        whole = path.read_bytes()
        path.write_bytes(mutated(random, whole))
        before = contents(tmp_path)
        try:
            series = read_series(tmp_path)
        except DicError as error:
            assert str(tmp_path) in str(error)
        else:
            assert np.isfinite(series.x).all() and np.isfinite(series.y).all()
            assert not np.isinf([frame.displacement for frame in series.frames]).any()
        assert contents(tmp_path) == before
        path.write_bytes(whole)


@pytest.mark.parametrize("name", RECORDS)
def test_a_damaged_record_is_refused_or_read_as_finite_numbers(tmp_path, name):
    random = np.random.default_rng(zlib.crc32(name.encode()))
    time = np.linspace(0.0, 3.0, 12)
    whole, path = text(name, time, 0.1 * time, 1.5 + time).encode(), tmp_path / "force.csv"
    for _ in range(30):
        path.write_bytes(mutated(random, whole))
        before = contents(tmp_path)
        try:
            record = read_force_record(path)
        except DicError as error:
            assert str(path) in str(error)
        else:
            assert np.isfinite(record.force).all() and len(record.force)
            assert record.time is None or (np.diff(record.time) >= 0.0).all()
            assert record.image is None or not np.isinf(record.image).any()
        assert contents(tmp_path) == before
