"""Damage of any kind ends in one sentence or in numbers: never in another error, never in an infinity."""

import zlib

import numpy as np
import pytest

from hypernode.dic.errors import DicError
from hypernode.dic.reading import read_series
from tests.dic.exports import ASSEMBLED, FRAMES, export
from tests.dic.mutations import mutated
from tests.dic.refusals import contents


@pytest.mark.parametrize("case", [*FRAMES, *ASSEMBLED])
def test_a_damaged_file_is_refused_or_read_as_finite_numbers_and_lost_points(tmp_path, case):
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
