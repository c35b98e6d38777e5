"""A hyper-network resolves no more than the cells at whose centres it is trained."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from hypernode.config.methods import Frequencies
from hypernode.mechanics.loads import make_load
from hypernode.training.problem import LARGEST_FREQUENCY, InverseProblem
from tests.sheets import sheet


@pytest.mark.parametrize(("cells", "scale"), [(4, 4 * LARGEST_FREQUENCY), (48, 7.0)])
def test_frequencies_are_bounded_by_the_grid(cells, scale):
    lines = np.linspace(0.0, 3.0, cells + 1)
    grid = np.stack(np.meshgrid(lines, lines), axis=-1).reshape(-1, 2)
    first = (np.arange(cells) + (cells + 1) * np.arange(cells)[:, None]).ravel()
    data, _, _ = sheet(4, lambda X: X[:, 0] > 0.5, make_load("equibiaxial", [1.1]))
    data = data.drop_dims(["node", "cell"]).assign(
        X=(("node", "i"), grid),
        cells=(("cell", "vertex"), np.stack([first, first + 1, first + cells + 2, first + cells + 1], axis=1)),
        corners=(("corner", "i"), np.array([[0.0, 0.0], [3.0, 3.0]])),
    )
    method = SimpleNamespace(hypernetwork=Frequencies(features=10, frequency_scale=7.0, widths=[4]))
    stored = json.loads(InverseProblem("sheet", method, {"measurement": data}).hypernetwork)
    assert stored["frequency_scale"] == pytest.approx(scale)
    assert stored["features"] == 10 and stored["widths"] == [4]
