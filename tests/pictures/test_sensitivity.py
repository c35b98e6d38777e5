"""Grey noise alone scatters displacements as much as it is said to."""

import numpy as np
import pytest

from hypernode.config.pictures import Pictures, Speckle
from hypernode.fem.interpolation import NodalField
from hypernode.fem.mesh import rectilinear
from hypernode.pictures.photograph import light, recorded, sheet_mask
from hypernode.pictures.sensitivity import least_noise
from hypernode.pictures.speckle import Pattern, sprayed
from hypernode.pictures.view import view_of


def test_least_squares_shifts_of_noisy_pictures_scatter_as_said():
    side, subset, settings = 360, 15, Pictures(noise=4.0)
    mesh = rectilinear(*(np.linspace(0.0, 1.0, 3),) * 2)
    rest = NodalField.of(mesh, np.zeros_like(mesh.nodes))
    view = view_of(mesh.nodes[None], 1.0 / side, 10)
    grey = light(Pattern.of(sprayed((side, side), Speckle(seed=1)), (side, side)), rest, view, settings)
    first, second = (recorded(grey, settings, frame) for frame in (0, 1))
    mask = sheet_mask(rest, view)
    said = least_noise(first, mask, settings.noise, subset)
    gradients = np.gradient(grey)[::-1]
    difference = first.astype(float) - second
    for axis in (0, 1):
        shifts = []
        for row in range(14, 350, subset):
            for column in range(14, 350, subset):
                block = np.s_[row : row + subset, column : column + subset]
                g = gradients[axis][block]
                # In units of what the gradients of this subset make of the noise, so that each counts alike.
                shifts.append((g * difference[block]).sum() / np.sqrt((g**2).sum()) / (np.sqrt(2.0) * settings.noise))
        assert np.std(shifts) == pytest.approx(1.0, rel=0.1)
        mean = np.sqrt((gradients[axis][13:-13, 13:-13] ** 2).mean())
        assert said[axis] == pytest.approx(np.sqrt(2.0) * 4.0 / (subset * mean), rel=0.02)
