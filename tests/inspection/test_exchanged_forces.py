"""Forces along x and y that stand in each other's column are asked about, and ``force_channel`` answers either way."""

import re

import numpy as np
import pytest
import yaml

from hypernode.dic.forces.exchanged import definite, isotropic_ratios
from hypernode.inspection.folder import inspect
from tests.dic.pulls import LINES, NOISE, write
from tests.inspection.test_situations import said_of

#: A broad sheet: the same stress makes another force along each axis.
GIVEN = {"width": 12.0, "height": 12.0, "thickness": 1.0, "frame_rate": 1.0}
COUNT = 12
ALONG = {
    "evenly": lambda t: (t, 0.5 * t),
    "one after the other": lambda t: (np.minimum(2.0 * t, 1.0), np.clip(2.0 * t - 1.0, 0.0, 1.0)),
}


def rubber(strain):
    """Nominal stress (…, 2) of a neo-Hookean sheet."""
    a, b = np.moveaxis(1.0 + strain, -1, 0)
    return np.stack([a - a**-3.0 * b**-2.0, b - b**-3.0 * a**-2.0], axis=-1)


def steep(strain):
    """The same of a law of I2 beside I1, as rubber has at most."""
    a, b = np.moveaxis(1.0 + strain, -1, 0)
    c = 1.0 / (a * b)
    return rubber(strain) + 0.5 * np.stack([(a**2 - c**2) * b**2 / a, (b**2 - c**2) * a**2 / b], axis=-1)


def fibres(factor, power):
    """Rubber with fibres along x."""

    def stress(strain):
        a = 1.0 + strain[..., 0]
        along = factor * (a**2 - 1.0) * np.exp(power * (a**2 - 1.0) ** 2) * a
        return rubber(strain) + np.stack([along, 0.0 * along], axis=-1)

    return stress


LAWS = {"rubber": rubber, "steep": steep, "fibres": fibres(5.0, 20.0), "a few fibres": fibres(0.3, 0.5)}


def strains(path, largest=0.1, count=COUNT):
    return largest * np.stack(ALONG[path](np.linspace(0.0, 1.0, count)), axis=-1)


def pulled(folder, path, law, exchanged=False):
    y, x = np.meshgrid(LINES, LINES, indexing="ij")
    rng = np.random.default_rng(8)
    write(
        folder,
        [e * np.stack([x, y], axis=-1) + (e.any()) * rng.normal(0.0, NOISE, (13, 13, 2)) for e in strains(path)],
    )
    time = np.linspace(0.0, COUNT - 1.0, 111)
    force = 12.0 * law(strains(path, count=111))
    force = force[:, ::-1] if exchanged else force
    rows = [f"{t:.3f},{fx:.7f},{fy:.7f}" for t, (fx, fy) in zip(time, force, strict=True)]
    (folder / "force_disp.csv").write_text("\n".join(["Time (s),Force x [N],Force y [N]", *rows]) + "\n")
    return folder


def forces_are(found, path, law):
    case = found.sheet.cases[0]
    right = 12.0 * law(strains(path))[case.numbers]
    np.testing.assert_allclose(np.stack([case.force[0, 0], case.force[1, 1]], axis=1), right, rtol=5e-3)


@pytest.mark.parametrize("path", ALONG)
def test_exchanged_forces_are_asked_about_and_right_once_their_columns_are_named(tmp_path, path):
    folder = pulled(tmp_path / "pull", path, rubber, exchanged=True)
    exchange, _ = re.findall(r'--set "force_channel=({.*?})"', said_of(inspect(folder, GIVEN)))
    found = inspect(folder, {**GIVEN, "force_channel": yaml.safe_load(exchange)})
    assert not said_of(found)
    forces_are(found, path, rubber)


@pytest.mark.parametrize("path", ALONG)
@pytest.mark.parametrize("law", LAWS)
def test_right_forces_are_not_asked_about(tmp_path, path, law):
    found = inspect(pulled(tmp_path / "pull", path, LAWS[law]), GIVEN)
    assert "exchanged" not in said_of(found)
    forces_are(found, path, LAWS[law])


def test_a_sheet_that_looks_exchanged_is_taken_as_it_is_said(tmp_path):
    folder = pulled(tmp_path / "pull", "evenly", rubber, exchanged=True)
    found = inspect(folder, {**GIVEN, "force_channel": {"x": "Force x [N]", "y": "Force y [N]"}})
    assert not said_of(found)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("largest", [0.02, 0.1, 0.3, 1.0])
def test_no_stable_sheet_has_a_stiffness_that_is_not_definite(law, largest):
    rng = np.random.default_rng(3)
    strain = strains("one after the other", largest, 30)
    stress = LAWS[law](strain) * (1.0 + 0.01 * rng.standard_normal(strain.shape))
    told = definite(strain, stress)
    assert told is None or told > 0.0
    assert definite(strain, stress[:, ::-1]) == (told if told is None else -told)


def test_axes_that_are_pulled_in_proportion_leave_the_stiffness_open():
    assert definite(strains("evenly"), rubber(strains("evenly"))) is None


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("largest", [0.02, 0.2, 1.0])
def test_isotropic_sheets_lie_between_the_ratios_of_their_bounds(share, largest):
    strain = strains("evenly", largest)[1:]
    stress = (1.0 - share) * rubber(strain) + share * (steep(strain) - rubber(strain))
    low, high = isotropic_ratios(strain)
    ratio = stress[:, 0] / stress[:, 1]
    assert (low <= ratio * (1.0 + 1e-9)).all() and (ratio <= high * (1.0 + 1e-9)).all()
