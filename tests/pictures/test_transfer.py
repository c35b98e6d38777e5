"""What engines make of waves: the analytical kernels, and the measured sides that measurements carry."""

import numpy as np
import pytest
from scipy.integrate import quad

from hypernode.config.correlation import Correlation
from hypernode.config.pictures import Pictures
from hypernode.pictures import transfer
from hypernode.pictures.correlation import PYTHONS, Correlated, python_of
from hypernode.pictures.errors import EngineMissing
from hypernode.pictures.transfer import KERNELS, measured, photographed_waves, wave
from hypernode.pictures.window import WINDOWS, window_of

WEIGHTS = {"average": lambda t: 0.5, "quadratic": lambda t: (9.0 - 15.0 * t**2) / 8.0}


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("ratio", [0.0, 1e-3, 0.1, 0.7, 1.0, 1.6])
def test_gains_are_the_integrals_of_their_kernels(kernel, ratio):
    wanted = quad(lambda t: WEIGHTS[kernel](t) * np.cos(np.pi * ratio * t), -1.0, 1.0)[0]
    assert KERNELS[kernel](np.array([ratio]))[0] == pytest.approx(wanted, abs=1e-9)


def seen_by(kernel, share, noise):
    """An engine that sees exactly through a kernel."""

    def correlate(pictures, mask, settings, threads):
        random = np.random.default_rng(0)
        lines = np.arange(15, mask.shape[0] - 15, settings.step)
        row, column = (each.ravel() for each in np.meshgrid(lines, lines, indexing="ij"))
        u = np.zeros((len(pictures), len(row), 2))
        for frame, ratio in enumerate(transfer.WAVELENGTHS):
            gain = KERNELS[kernel](np.array([share / ratio]))[0]
            u[frame + 2, :, 0] = gain * wave(column, ratio * settings.subset)
        u[1:] += noise * random.normal(size=u[1:].shape)
        return Correlated(column=column, row=row, displacement=u, correlation=np.ones(u.shape[:2]), step=settings.step)

    return correlate


@pytest.mark.parametrize(("kernel", "share"), [("average", 0.9), ("quadratic", 1.1)])
def test_kernel_side_and_noise_of_a_known_engine_are_found(kernel, share, monkeypatch):
    monkeypatch.setattr(transfer, "correlate", seen_by(kernel, share, 0.005))
    found = measured(Correlation(subset=15, step=5), Pictures(), side=150)
    assert found.kernel == kernel and found.misfit[kernel] < 0.02
    assert abs(found.width - share) < 4.0 * found.width_error < 0.2
    assert found.noise == pytest.approx(0.005, rel=0.1) and 0.0 < found.noise_length < 5.0


def test_waves_are_photographed_where_the_displacement_has_brought_them():
    quiet = Pictures(noise=0.0)
    pictures, wavelength = photographed_waves(15, 120, quiet)
    assert len(pictures) == len(wavelength) + 2
    # At the zeros of the wave the picture is the one at rest, elsewhere it is not.
    rest, waved = pictures[0].astype(float), pictures[2 + transfer.WAVELENGTHS.index(4.0)].astype(float)
    difference = np.sqrt(np.mean((rest - waved) ** 2, axis=0))
    assert difference[[0, 30, 60, 90]].max() < 1.0 < 5.0 < difference[[15, 45, 75]].min()


def test_a_window_is_that_of_its_engine():
    assert window_of(Correlation(subset=25, step=8)) == (pytest.approx(0.98 * 25), "average")
    assert window_of(Correlation(subset=25, step=8, shape="quadratic"))[1] == "quadratic"


@pytest.mark.parametrize(("engine", "shape"), [each for each in WINDOWS if each[0] in PYTHONS])
def test_engines_see_as_measurements_say(engine, shape):
    try:
        python_of(engine)
    except EngineMissing as error:
        pytest.skip(str(error))
    kernel, share = WINDOWS[engine, shape]
    found = measured(Correlation(engine=engine, subset=21, step=8, shape=shape, reach=40), Pictures(), side=300)
    assert found.kernel == kernel and found.misfit[kernel] < 0.02
    assert found.width == pytest.approx(share, abs=0.03)
