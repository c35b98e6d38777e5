"""Laws of the acceptance study's sheets: what they are compared with has to be right itself."""

import dataclasses

import numpy as np
import pytest

from benchmarks.level import designs
from benchmarks.strangers.design import SIDE, THICKNESS, Sheet, design
from benchmarks.strangers.laws import LAWS, WRONG, stress
from benchmarks.strangers.report import draw, notes, table_of
from benchmarks.strangers.score import relative_error, score
from benchmarks.strangers.solve import solve
from benchmarks.strangers.write import write_test, write_truth
from hypernode.config.loading import load_config
from hypernode.dic.specimen import import_specimen
from hypernode.storage.errors import StorageError

MU = 0.4
PLAIN = Sheet(
    **{"seed": 1, "shape": "none", "kind": "neo_hookean", "load": "biaxial", "laws": {"mu": np.array([MU])}},
    **{"top": 0.2, "across": 0.8, "points": 9, "seen": 1.0, "window": 0.0, "noise": 0.0, "step_pixels": 20.0},
    **{"force_scatter": 0.0, "force_gain": 0.0, "force_zero": 0.0},
)


def nominal(stretch, other):
    """Nominal stress of a neo-Hookean sheet along one axis [MPa], in closed form."""
    return MU * (stretch - 1.0 / (stretch**3 * other**2))


@pytest.fixture(scope="module")
def plain():
    return solve(PLAIN, loads=3)


@pytest.mark.parametrize("kind", LAWS)
def test_stress_vanishes_at_rest_and_the_shear_modulus_is_the_one_that_is_stated(kind):
    rng = np.random.default_rng(3)
    laws = {"mu": np.array([MU])} | {name: rng.uniform(*bounds, 1) for name, bounds in LAWS[kind][1].items()}
    if kind == "goh":
        laws["k1"] = np.array([0.0])
    small = 1e-5
    F = np.array([np.eye(2), [[1.0, small], [0.0, 1.0]]])
    rest, sheared = stress(kind, laws, F, np.ones((2, 1)))
    np.testing.assert_allclose(rest, 0.0, atol=1e-12)
    # A series of the inverse Langevin function begins above its first term.
    chain = sum(c * n * 3.0 ** (n - 1) / laws["N"][0] ** (n - 1) * 2 for n, c in CHAIN) if kind == "arruda_boyce" else 1
    assert sheared[0, 1] == pytest.approx(MU * chain * small, rel=1e-3)


@pytest.mark.parametrize("kind", WRONG)
def test_laws_that_no_basis_has_are_free_of_stress_at_rest_and_carry_a_pull(kind):
    further = next((numbers for of, numbers, _ in designs.WRONG.values() if of == kind), {})
    laws = {"mu": np.array([MU]), "grown": np.ones(1)} | {name: np.array([value]) for name, value in further.items()}
    rest, pulled = stress(kind, laws, np.array([np.eye(2), np.diag([1.0, 1.2])]), np.ones((2, 1)))
    np.testing.assert_allclose(rest, 0.0, atol=1e-12)
    assert pulled[1, 1] > 0.05 * MU


def test_a_compressible_sheet_is_free_of_stress_across_and_keeps_its_volume_where_that_is_stiff():
    F, laws = np.array([np.diag([1.05, 1.2])]), {"mu": np.array([MU])}
    stiff, kept = (
        stress(kind, laws | {"bulk": np.array([1e5])}, F, np.ones((1, 1))) for kind in ("compressible", "neo_hookean")
    )
    np.testing.assert_allclose(stiff, kept, rtol=1e-3, atol=1e-6)
    # With no stress across, P_x l_x - P_y l_y is mu (l_x^2 - l_y^2), whatever the volume.
    soft = stress("compressible", laws | {"bulk": np.array([1.0])}, F, np.ones((1, 1)))[0]
    assert soft[0, 0] * 1.05 - soft[1, 1] * 1.2 == pytest.approx(MU * (1.05**2 - 1.2**2), rel=1e-6)
    assert soft[1, 1] < kept[0, 1, 1]


def test_a_law_that_fades_or_grows_does_so_with_the_load_and_a_thickness_from_side_to_side():
    sheet = dataclasses.replace(PLAIN, laws={"mu": np.array([MU, MU])}, fades=0.4, grows=0.1, thins=0.3)
    half = sheet.laws_at(0.5)
    np.testing.assert_allclose(half["mu"], [MU, 0.8 * MU])
    np.testing.assert_allclose(half["grown"], [1.0, 1.05])
    np.testing.assert_allclose(sheet.relative_thickness([[0.0, 0.0], [SIDE, 1.0]]).ravel(), [0.85, 1.15])


CHAIN = list(enumerate((1 / 2, 1 / 20, 11 / 1050, 19 / 7000, 519 / 673750), start=1))


def test_a_homogeneous_sheet_has_the_forces_of_the_closed_form(plain):
    for amount, force in zip(plain.amount, plain.force, strict=True):
        x, y = 1.0 + 0.16 * amount, 1.0 + 0.2 * amount
        np.testing.assert_allclose(force, [nominal(x, y) * SIDE, nominal(y, x) * SIDE], rtol=1e-8)
    at = np.array([[0.0, 0.0], [7.3, 11.9], [SIDE, SIDE]])
    np.testing.assert_allclose(plain.displacement(at)[-1], at * [0.16, 0.2], atol=1e-7)


def test_a_clamped_sheet_of_two_materials_balances_its_ends(tmp_path):
    laws = {"mu": np.array([MU, 3 * MU])}
    sheet = dataclasses.replace(PLAIN, shape="discs", laws=laws, load="clamped_y")
    found = solve(sheet, loads=2)
    # What crosses every line across the sheet is the same force: by finite differences of the displacement on one.
    x = (np.arange(400) + 0.5) / 400 * SIDE
    h, forces = 1e-4, []
    for height in (0.1 * SIDE, 0.5 * SIDE, 0.9 * SIDE):
        X = np.stack([x, np.full_like(x, height)], axis=1)
        moved = [(found.displacement(X + d) - found.displacement(X - d))[-1] / (2 * h) for d in h * np.eye(2)]
        F = np.eye(2) + np.stack(moved, axis=-1)
        forces.append(stress(sheet.kind, laws, F, sheet.weights(X))[:, 1, 1].mean() * SIDE)
    np.testing.assert_allclose(forces, found.force[-1, 1], rtol=0.01)


def test_a_sheet_that_is_stretched_in_the_first_picture_moves_from_there_and_its_record_begins_with_a_force(
    plain, tmp_path
):
    sheet = dataclasses.replace(PLAIN, preload=0.02, late=2.0)
    write_test(sheet, plain, tmp_path)
    record = np.loadtxt(tmp_path / "test" / "force_disp.csv", delimiter=",", skiprows=2)
    first = nominal(1.02, 1.016) * SIDE * THICKNESS
    # Two frames of a clock that is late are eight rows of the record.
    np.testing.assert_allclose(record[:9, 2], first, rtol=5e-3)
    assert record[9, 2] > 1.05 * first
    _, y, _, v = np.loadtxt(tmp_path / "test" / "sheet_025.csv", delimiter=";", skiprows=1).T
    height = (y.max() - y) / sheet.step_pixels * sheet.step
    # Where the first picture shows a point, it lay at a height of that over 1.02 at rest; beyond the sheet is nothing.
    inside = height < 0.95 * SIDE
    np.testing.assert_allclose(
        -v[inside] / sheet.step_pixels * sheet.step, height[inside] * (1.2 / 1.02 - 1.0), atol=5e-3
    )


def test_files_say_what_was_solved(plain, tmp_path, monkeypatch):
    # A point that does not move at all would count as lost.
    write_test(dataclasses.replace(PLAIN, noise=1e-3), plain, tmp_path)
    monkeypatch.chdir(tmp_path)
    specimen = load_config(tmp_path / "sheet.yaml").specimens["sheet"]
    read = import_specimen(specimen)
    np.testing.assert_allclose(read.u[-1], read.mesh.nodes * [0.16, 0.2] * (read.stretch[-1] - 1) / 0.2, atol=2e-3)
    x, y = 1.0 + read.H[-1, 0, 0], 1.0 + read.H[-1, 1, 1]
    assert read.edge_force[-1, 1, 0] == pytest.approx(nominal(x, y) * SIDE * THICKNESS, rel=2e-3)
    assert read.edge_force[-1, 3, 1] == pytest.approx(nominal(y, x) * SIDE * THICKNESS, rel=2e-3)


def test_noise_has_the_size_that_is_stated_and_neighbours_share_it_behind_a_window(plain, tmp_path):
    for window, correlation in ((0.0, 0.0), (2.5, 0.6)):
        sheet = dataclasses.replace(PLAIN, points=41, noise=0.05, window=window)
        folder = tmp_path / str(window)
        write_test(dataclasses.replace(sheet, noise=0.0), plain, folder / "exact")
        write_test(sheet, plain, folder / "noisy")
        exact, noisy = (
            np.loadtxt(folder / name / "test" / "sheet_009.csv", delimiter=";", skiprows=1)[:, 2]
            for name in ("exact", "noisy")
        )
        error = (noisy - exact).reshape((41 - 2 * sheet.kept.start,) * 2)
        assert error.std() == pytest.approx(0.05, rel=0.12)
        assert np.corrcoef(error[:, 1:].ravel(), error[:, :-1].ravel())[0, 1] == pytest.approx(correlation, abs=0.1)


def test_the_truth_is_that_of_the_deformation_that_was_seen(plain, tmp_path):
    write_truth(PLAIN, plain, tmp_path / "truth.npz")
    truth = np.load(tmp_path / "truth.npz")
    np.testing.assert_allclose(truth["F"][-1], np.broadcast_to(np.diag([1.16, 1.2]), truth["F"][-1].shape), atol=1e-7)
    np.testing.assert_allclose(truth["P"][-1, :, 1, 1], nominal(1.2, 1.16), rtol=1e-6)
    assert truth["whole"].all() and truth["X"].min() == pytest.approx(PLAIN.step / 2)
    wrong = 1.05 * truth["P"]
    assert relative_error(wrong, truth["P"], truth["whole"]) == pytest.approx(0.05)


def test_a_seed_is_always_the_same_sheet_and_others_are_others():
    one, again, other = design(7), design(7), design(8)
    X = np.random.default_rng(0).uniform(0.0, SIDE, (500, 2))
    np.testing.assert_array_equal(one.weights(X), again.weights(X))
    assert repr(one) == repr(again) != repr(other)
    sheets = [design(seed) for seed in range(1, 60)]
    assert {sheet.kind for sheet in sheets} == set(LAWS) and len({sheet.shape for sheet in sheets}) == 5
    for sheet in sheets:
        np.testing.assert_allclose(sheet.weights(X).sum(axis=1), 1.0)
        assert sheet.phases == 1 or sheet.weights(X)[:, 1:].max() > 0.5, sheet


def test_a_sheet_without_a_result_is_refused_and_a_row_with_an_error_stands_in_the_table(tmp_path):
    with pytest.raises(StorageError, match="evaluation"):
        score(tmp_path, tmp_path / "truth.npz")
    modes = ("equibiaxial", "along x", "along y", "shear")
    errors = {f"{p}{n}": 0.02 for p in ("", "field ") for n in ("tested", "everywhere", *modes)}
    good = {"seed": 1, "verdict": "pass", "because": "", "cpu_s": 5.0, "clock_s": 6.0, "level": 1.0, **errors}
    rows = [good, {"seed": 2, "error": "NoEquilibrium: seed 2"}]
    frame = table_of(rows).frame
    assert frame["error"].tolist()[1] == "NoEquilibrium: seed 2" and frame["tested"].isna().tolist() == [False, True]
    assert notes(rows)[0] == "2 sheets, 1 scored." and notes(rows[1:]) == ["1 sheets, 0 scored."]
    draw(rows), draw(rows[1:])
