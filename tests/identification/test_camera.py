"""Seeing through a correlation window."""

import numpy as np
import pytest

from hypernode.fem.mesh import rectilinear
from hypernode.identification.camera import line_average, line_quadratic, window_average

LINES = np.array([0.0, 0.1, 0.25, 0.4, 0.5, 0.7, 0.8, 1.0])


@pytest.mark.parametrize("width", [0.05, 0.2, 0.6])
def test_a_linear_field_looks_the_same_through_any_window(width):
    mesh = rectilinear(LINES, LINES)
    field = mesh.nodes @ np.array([[0.1, 0.3], [-0.2, 0.2]]) + 0.5
    seen = (window_average(mesh, width) @ field.ravel()).reshape(-1, 2)
    np.testing.assert_allclose(seen, field, atol=1e-12)


def test_a_kink_is_rounded_by_the_window_average_of_its_neighbourhood():
    x = np.linspace(0.0, 1.0, 11)
    seen = line_average(x, 0.1) @ np.abs(x - 0.5)
    # Mean of |s| over [-0.05, 0.05]; one cell further on the field is linear over the window.
    assert seen[5] == pytest.approx(0.025)
    np.testing.assert_allclose(np.delete(seen, 5), np.delete(np.abs(x - 0.5), 5), atol=1e-12)


def test_beyond_the_edge_the_field_goes_on_antisymmetrically():
    x = np.linspace(0.0, 1.0, 11)
    np.testing.assert_allclose((line_average(x, 0.3) @ x**2)[[0, -1]], [0.0, 1.0], atol=1e-12)


def test_nodes_whose_window_meets_a_hole_are_taken_as_they_are():
    keep = np.ones((7, 7), dtype=bool)
    keep[3, 3] = keep[3, 4] = keep[4, 3] = keep[4, 4] = False
    mesh = rectilinear(LINES, LINES, keep)
    average = window_average(mesh, 0.4)
    hole_edge = np.flatnonzero((np.abs(mesh.nodes - (0.4, 0.4)) < 1e-9).all(axis=1))[0]
    row = average[2 * hole_edge].toarray().ravel()
    assert row[2 * hole_edge] == 1.0 and np.abs(row).sum() == 1.0
    assert (np.asarray(average.sum(axis=1)) == pytest.approx(1.0)) and (average[0] != 0).sum() >= 1


@pytest.mark.parametrize("width", [0.05, 0.2, 0.6])
def test_a_linear_field_looks_the_same_through_a_quadratic_fit(width):
    mesh = rectilinear(LINES, LINES)
    field = mesh.nodes @ np.array([[0.1, 0.3], [-0.2, 0.2]]) + 0.5
    seen = (window_average(mesh, width, "quadratic") @ field.ravel()).reshape(-1, 2)
    np.testing.assert_allclose(seen, field, atol=1e-12)


def test_a_quadratic_field_looks_the_same_through_a_quadratic_fit_and_not_through_an_average():
    x = np.linspace(-1.0, 1.0, 401)
    inner = np.abs(x) < 0.8
    # The interpolant lies above the parabola by a sixth of the step squared, on average.
    np.testing.assert_allclose((line_quadratic(x, 0.3) @ x**2)[inner], x[inner] ** 2 + 0.005**2 / 6.0, atol=1e-8)
    np.testing.assert_allclose((line_average(x, 0.3) @ x**2)[inner] - x[inner] ** 2, 0.3**2 / 12.0, rtol=1e-3)


@pytest.mark.parametrize("wavelength", [0.2, 0.3, 0.8])
@pytest.mark.parametrize(("kernel", "line"), [("average", line_average), ("quadratic", line_quadratic)])
def test_a_wave_loses_what_the_integral_over_the_window_says(kernel, line, wavelength):
    x, width = np.linspace(0.0, 2.0, 801), 0.2
    t = (np.arange(20000) + 0.5) / 10000 - 1.0
    weight = {"average": np.full_like(t, 0.5), "quadratic": (9.0 - 15.0 * t**2) / 8.0}[kernel]
    gain = np.sum(weight * np.cos(np.pi * width / wavelength * t)) / 10000
    wave = np.sin(2.0 * np.pi * x / wavelength)
    inner = (x > width) & (x < 2.0 - width)
    # The interpolant of a wave loses a twelfth of the phase of an element, squared.
    lost = (2.0 * np.pi / wavelength * 0.0025) ** 2 / 12.0
    np.testing.assert_allclose((line(x, width) @ wave)[inner], gain * wave[inner], atol=lost + 1e-7)


def test_a_quadratic_fit_over_a_square_is_that_of_least_squares():
    line = np.linspace(0.0, 1.0, 41)
    mesh = rectilinear(line, line)
    field = np.stack([np.sin(4.5 * mesh.nodes[:, 0]) * np.cos(3.5 * mesh.nodes[:, 1]), mesh.nodes[:, 0] ** 3], axis=1)
    width, middle = 0.4, np.array([0.35, 0.25])
    t = ((np.arange(400) + 0.5) / 400 - 0.5) * width
    X, Y = (each.ravel() for each in np.meshgrid(middle[0] + t, middle[1] + t))
    wanted = np.sin(4.5 * X) * np.cos(3.5 * Y)
    x, y = X - middle[0], Y - middle[1]
    basis = np.stack([np.ones_like(X), x, y, x**2, x * y, y**2], 1)
    fitted = np.linalg.lstsq(basis, wanted, rcond=None)[0][0]
    node = np.flatnonzero((np.abs(mesh.nodes - middle) < 1e-9).all(axis=1))[0]
    seen = window_average(mesh, width, "quadratic") @ field.ravel()
    # Elements of 1/40 lose (4.5 / 40)^2 / 12 of the wave.
    assert seen[2 * node] == pytest.approx(fitted, abs=2e-3)
    assert abs((window_average(mesh, width) @ field.ravel())[2 * node] - fitted) > 0.05
