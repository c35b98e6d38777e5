"""The figure of a folder shows what there is, with units, and says what there is not."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

from hypernode.figures.folder import draw, write
from hypernode.inspection.forces import Course
from hypernode.inspection.view import FolderView, largest_strain

X, Y = np.linspace(0.0, 4.0, 9), np.linspace(0.0, 3.0, 7)


def view(lost=(), forces=True, **changes):
    grid = np.stack(np.meshgrid(X, Y), axis=-1)
    u = grid * np.array([-0.04, 0.1])
    for place in lost:
        u[place] = np.nan
    numbers = [1, 3, 5]
    stretch = np.array([[1.0, 1.0, 0.0], [0.98, 1.05, 0.0], [0.96, 1.1, 0.0]])
    course = Course((1, 1), np.array(numbers), stretch[:, 1], np.array([0.0, 2.0, 3.0]))
    share = np.array([0.0, 0.0, len(lost) / (len(X) * len(Y))])
    courses = (course,) if forces else ()
    fields = {"title": "pull", "unit": "mm", "x": X, "y": Y, "ring": 1, "frame": 5, "displacement": u}
    fields |= {"numbers": numbers, "lost": share, "stretch": stretch, "chosen": [5], "courses": courses}
    return FolderView(**{**fields, **changes})


def test_the_largest_strain_of_a_uniform_field_is_that_of_its_gradient():
    H = np.array([[0.1, 0.3], [-0.05, 0.2]])
    grid = np.stack(np.meshgrid(X, Y), axis=-1)
    E = 0.5 * (H + H.T + H.T @ H)
    np.testing.assert_allclose(largest_strain(X, Y, grid @ H.T), np.linalg.eigvalsh(E)[-1])


def test_strain_is_not_known_beside_a_lost_point():
    u = view(lost=[(2, 3)]).displacement
    unknown = np.isnan(largest_strain(X, Y, u))
    assert unknown.sum() == 4 and unknown[1:3, 2:4].all()


def drawn(figure):
    texts = [axes.get_xlabel() + " " + axes.get_ylabel() for axes in figure.axes]
    legends = [text.get_text() for axes in figure.axes if axes.get_legend() for text in axes.get_legend().get_texts()]
    plt.close(figure)
    return " ".join(texts), legends


def test_axes_have_units_and_load_steps_are_marked():
    texts, legends = drawn(draw(view()))
    for label in ("$x$ [mm]", "$|u|$ [mm]", "max. principal strain [-]", "force [N]", "number of the frame"):
        assert label in texts
    assert "load steps" in legends and "lost points" not in legends and "lost points" not in texts


def test_lost_points_are_marked_where_they_were_and_counted():
    texts, legends = drawn(draw(view(lost=[(2, 3), (0, 0)])))
    assert "lost points [%]" in texts and legends.count("lost points") == 2


def test_what_is_not_known_is_said():
    figure = draw(view(forces=False, chosen=[], unit="pixel"))
    assert any("no force is known" in text.get_text() for text in figure.axes[2].texts)
    assert "$x$ [pixel]" in drawn(figure)[0]


@pytest.mark.parametrize("kind", ["pdf", "png"])
def test_the_same_folder_is_the_same_file(kind, tmp_path):
    for name in ("a", "b"):
        write(view(), [tmp_path / f"{name}.{kind}"])
    first, second = ((tmp_path / f"{name}.{kind}").read_bytes() for name in ("a", "b"))
    assert first == second and len(first) > 5000
