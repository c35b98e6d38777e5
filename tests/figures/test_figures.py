"""What every figure promises: the numbers of its files, units, shared scales, embedded fonts, the same bytes."""

import json
import re

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection

from hypernode.figures.comparison import ComparisonError
from hypernode.figures.deformation import DeformationError
from hypernode.figures.detection import DetectionError, wilson
from hypernode.figures.render import LAYOUTS, compose
from hypernode.figures.style import RC, colour_bar, draw_field, save, shared_norm, unit_label
from tests.figures.data import evaluation, figure_input, references, without_inclusion


@pytest.fixture(autouse=True)
def _closed():
    yield
    plt.close("all")


def panel(figure, letter):
    return next(axes for axes in figure.axes if axes.get_title(loc="left").startswith(f"({letter})"))


def field(axes):
    return next(artist for artist in axes.collections if isinstance(artist, PolyCollection))


@pytest.mark.slow
@pytest.mark.parametrize("kind", LAYOUTS)
def test_a_figure_is_the_same_file_every_time_with_its_fonts_in_it(kind, tmp_path, monkeypatch):
    monkeypatch.setitem(RC, "savefig.dpi", 40)
    contents = []
    for folder in ("first", "second"):
        files = {form: str(tmp_path / folder / f"f.{form}") for form in ("pdf", "png")}
        save(compose(*figure_input(kind, "fail")), files, {"rule": "figure"}, [])
        contents.append([(tmp_path / folder / f"f.{form}").read_bytes() for form in ("pdf", "png")])
    assert contents[0] == contents[1]
    pdf, png = contents[0]
    assert b"/FontFile2" in pdf and b"/Type3" not in pdf
    assert b"Date" not in pdf and b"tIME" not in png


@pytest.mark.parametrize("kind", LAYOUTS)
def test_every_axis_and_colour_bar_has_a_unit(kind):
    figure = compose(*figure_input(kind, "pass"))
    labels = {label for axes in figure.axes for label in (axes.get_xlabel(), axes.get_ylabel()) if label}
    # Rows of a comparison are named, and the error below a panel is a sentence.
    labels = {label for label in labels if not label.startswith(("truth", "first", "second", "error"))}
    assert labels and all(re.search(r" \[[^]]+\]$", label) for label in labels)


def test_a_detection_curve_counts_the_runs_of_each_contrast_and_bounds_their_share():
    data, settings = figure_input("detection", "pass")
    data["evaluation4"] = data["evaluation3"]
    figure = compose(data, settings)
    found = {round(float(line.get_xdata()[0])): line.get_ydata()[0] for line in panel(figure, "a").lines[1::2]}
    assert found == {0: 0.0, 10: 0.0, 20: 100.0, 30: 100.0}
    assert [text.get_text() for text in panel(figure, "a").texts] == ["0/1", "0/1", "1/1", "2/2"]
    # Wilson's interval of 0 of 20 and of 10 of 20 runs.
    assert wilson(0, 20) == pytest.approx((0.0, 0.161), abs=1e-3)
    assert wilson(10, 20) == pytest.approx((0.299, 0.701), abs=1e-3)
    unknown = {"evaluation0": data["evaluation0"].assign_attrs(summary=json.dumps({"inclusion": "not judged"}))}
    with pytest.raises(DetectionError, match="posterior_samples"):
        compose(unknown, settings)


def test_a_figure_of_pictures_shows_points_what_is_lost_and_the_error_in_pixels():
    data, settings = figure_input("pictures", "pass")
    figure = compose(data, settings)
    at_rest, close, later = (panel(figure, letter) for letter in "abc")
    np.testing.assert_array_equal(at_rest.images[0].get_array(), data["pictures"]["picture"].values[0])
    np.testing.assert_array_equal(later.images[0].get_array(), data["pictures"]["picture"].values[-1])
    points, lost = at_rest.lines
    assert len(points.get_xdata()) == 25 and at_rest.get_title(loc="left") == "(a) 25 points, 1 lost"
    column, row = (data["correlated"][f"pixel_{axis}"].values for axis in ("column", "row"))
    assert (lost.get_xdata().tolist(), lost.get_ydata().tolist()) == ([column[7]], [row[7]])
    assert close.patches[0].get_width() == 5.0 and later.get_title(loc="left").endswith("1.1")
    # Row 0 of points is at the top, as that of the pictures.
    grid = panel(figure, "d").images[0].get_array()
    assert grid.mask[3, 2] and grid.mask.sum() == 1
    u = data["measurement"]["u_measured"].values[0, -1]
    for letter, values in (("e", np.linalg.norm(u, axis=1)), ("f", 16.0 * 0.1 * np.linalg.norm(u, axis=1))):
        shown = field(panel(figure, letter)).get_array()
        cells = values[data["measurement"]["cells"].values].mean(axis=1)
        assert np.array_equal(shown.mask, np.isnan(cells)) and shown.mask.sum() == 4
        np.testing.assert_allclose(shown[~shown.mask], cells[np.isfinite(cells)])


def test_the_panels_show_the_numbers_of_the_file():
    data, settings = figure_input("identification", "pass")
    figure, file = compose(data, settings), data["evaluation"]
    assert np.array_equal(field(panel(figure, "a")).get_array(), file["principal_strain_measured"][-1])
    assert np.array_equal(field(panel(figure, "b")).get_array(), np.trace(file["P_field"].values[-1], axis1=1, axis2=2))
    assert np.array_equal(field(panel(figure, "d")).get_array(), file["trace_P"])
    forces = {line.get_marker(): [] for line in panel(figure, "e").lines}
    for line in panel(figure, "e").lines:
        forces[line.get_marker()].append(line.get_ydata())
    for marker, key in (("o", "edge_force"), ("x", "edge_force_at_identified"), ("+", "edge_force_at_measured")):
        # The edges on the right and at the top, both components.
        assert np.array_equal(forces[marker], file[key].values[:, [1, 1, 3, 3], [0, 1, 0, 1]].T)


def test_truth_and_identified_material_share_their_colours():
    figure = compose(*figure_input("identification", "pass"))
    scales = [field(panel(figure, letter)).get_clim() for letter in "cd"]
    assert scales[0] == scales[1]


@pytest.mark.parametrize("kind", ["identification", "overview", "anisotropy"])
def test_a_run_without_inclusion_has_no_second_curve_and_no_contour(kind):
    data, settings = figure_input(kind, "pass")
    with_one = compose(data, settings)
    without = compose(data | {"evaluation": without_inclusion(data["evaluation"])}, settings)

    def named(figure):
        return [text for axes in figure.axes for text in axes.get_legend_handles_labels()[1]]

    assert any(text.startswith("inclusion") for text in named(with_one))
    assert named(without) == [text for text in named(with_one) if not text.startswith("inclusion")]
    for figure, outlined in ((with_one, kind != "anisotropy"), (without, False)):
        lines = [each for axes in figure.axes for each in axes.collections if isinstance(each, LineCollection)]
        # A colour bar has an empty one of its own.
        assert any(len(each.get_segments()) > 3 for each in lines) is outlined


@pytest.mark.parametrize("kind", ["identification", "overview"])
def test_a_run_without_inclusion_says_which_contrast_would_have_been_seen(kind):
    data, settings = figure_input(kind, "pass")
    figure = compose(data | {"evaluation": without_inclusion(data["evaluation"])}, settings)
    titles = [axes.get_legend().get_title().get_text() for axes in figure.axes if axes.get_legend()]
    assert "no inclusion distinguishable;\ncontrasts above 3.45 %\nwould have been seen" in titles


def test_a_sheet_of_a_phase_that_was_not_found_is_drawn_without_a_number():
    summary = json.dumps({"reference_nrmse_matrix": 0.1, "reference_nrmse_inclusion": np.nan})
    file = references().assign_attrs(summary=summary)
    data, settings = figure_input("references", "pass")
    figure = compose(data | {"references": file}, settings)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "no inclusion was found" in labels and "identified matrix, NRMSE 10.0 %" in labels


def test_columns_of_a_comparison_share_their_colours_and_rows_their_error():
    figure = compose(*figure_input("comparison", "pass"))
    panels = np.array(figure.axes[:6]).reshape(3, 2)
    for column in panels.T:
        assert len({field(axes).get_clim() for axes in column}) == 1
    assert panels[1, 0].get_xlabel() == "error 0 %"
    # Half the sheet with 1.5 for 1, the other half 2 for 2.
    assert panels[2, 0].get_xlabel() == f"error {100 * 0.5 / 5**0.5:.1f} %"


def test_an_error_without_a_truth_is_refused_with_the_run_to_blame():
    data, settings = figure_input("comparison", "pass")
    del data["truth1"]
    with pytest.raises(ComparisonError, match="half/second has no known truth"):
        compose(data, settings | {"show": "error"})


def test_measured_and_interpolated_deformation_gradient_share_their_colours():
    figure = compose(*figure_input("anisotropy", "pass"))
    measured, used = (field(panel(figure, letter)) for letter in "cd")
    assert panel(figure, "d").get_title(loc="left") == "(d) interpolated $F_{xX}$"
    assert measured.get_clim() == used.get_clim()
    np.testing.assert_allclose(measured.get_array(), 1.1)
    np.testing.assert_allclose(np.unique(used.get_array()), [1.1, 1.11])


def test_true_and_identified_material_of_the_anisotropy_figure_share_their_colours():
    figure = compose(*figure_input("anisotropy", "pass"))
    scales = [field(panel(figure, letter)).get_clim() for letter in "af"]
    assert scales[0] == scales[1]


def test_a_figure_of_deformations_shows_displacement_strain_and_what_F_misses_on_scales_of_their_columns():
    data, settings = figure_input("deformation", "pass")
    panels = np.array(compose(data, settings).axes[:6]).reshape(2, 3)
    displacement, strain, missed = (field(axes) for axes in panels[1])
    u = 0.1 * np.linalg.norm(data["evaluation1"]["X"].values, axis=1)
    np.testing.assert_allclose(displacement.get_array(), u[data["evaluation1"]["cells"].values].mean(axis=1))
    assert np.array_equal(strain.get_array(), data["evaluation1"]["principal_strain_identified"].values[-1])
    np.testing.assert_allclose(np.unique(missed.get_array().round(9)), [0.0, 0.02])
    # Half of the cells are wrong by 0.02, of a gradient of norm 1.1 sqrt 2.
    assert panels[1, 2].get_xlabel() == f"error 0.0141, SNR {20 * np.log10(1.1 * 2 / 0.02):.1f} dB"
    for column in panels.T:
        assert len({field(axes).get_clim() for axes in column}) == 1


def test_a_deformation_that_is_not_known_is_refused_with_the_run_to_blame():
    data, settings = figure_input("deformation", "pass")
    data["measurement1"] = data["measurement1"].drop_vars("F_truth")
    with pytest.raises(DeformationError, match="deformation of half is not known"):
        compose(data, settings)


def test_a_colour_bar_is_pointed_where_values_lie_beyond_it():
    file = evaluation()
    figure, axes = plt.subplots()
    values = np.linspace(0.0, 1.0, file.sizes["cell"])
    for norm, extend in (
        (shared_norm(values), "neither"),
        (shared_norm([0.0, 0.9]), "max"),
        (shared_norm([0.1, 1.0]), "min"),
    ):
        assert colour_bar(figure, axes, draw_field(axes, file, values, norm), "x [-]").extend == extend


@pytest.mark.parametrize(("unit", "label"), [("1", " [-]"), ("", " [-]"), ("mm", " [mm]")])
def test_a_pure_number_has_a_dash_for_its_unit(unit, label):
    assert unit_label(unit) == label
