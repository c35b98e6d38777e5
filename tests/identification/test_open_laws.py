"""A law that explains a test as well is not forgotten: what it says of other deformations is part of the doubt."""

from types import SimpleNamespace

import jax.numpy as jnp
import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.evaluation.doubt import farther_half
from hypernode.identification import open_laws as laws_left_open
from hypernode.identification.force_course import ImpossibleForcesError
from hypernode.identification.open_laws import open_laws, terms_left
from hypernode.identification.strategy import of_parts
from hypernode.identification.volume import Parts, of_either, with_area
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.mechanics.loads import make_load
from hypernode.stages.constrained import OPEN_SAMPLES
from tests.sheets import SCALE, believed, sheet

NOISE, CELLS, STRETCH = 3e-4, 8, 1.2
SETTINGS = Constrained(terms=["I1_squared", "fibre"], layers=True, volume="told")
PULL = make_load("uniaxial_y", [1.07, 1.14, 1.2])
EQUIBIAXIAL = STRETCH * np.eye(2)


def nowhere(X):
    return np.zeros(len(X))


def observed(terms, values=(), load=PULL):
    """A noisy measurement of one material."""
    data, _, params = sheet(CELLS, nowhere, load, terms=terms, values=values)
    noise = np.random.default_rng(7).normal(0.0, NOISE, data["u_measured"].shape)
    data = believed(data.assign(u_measured=data["u_measured"] + noise), NOISE)
    return data.assign_attrs(mesh="finer", noise_uncertainty=0.05, force_uncertainty=0.01), params[0]


def stress(basis, params, F=EQUIBIAXIAL):
    return np.asarray(basis.stress(jnp.asarray(F)[:, :, None], jnp.asarray(params)[:, None]))[..., 0]


def doubt(found, laws):
    """Root mean square distance of the widest law from the field under equibiaxial stretch, over its stress."""
    own = stress(found.basis, found.by_parts[:, 0, 0])
    each = [
        farther_half(np.array([np.linalg.norm(stress(law.basis, s) - own) for s in law.samples[:, :, 0, 0].T]))
        for law in laws
    ]
    return max(each) / np.linalg.norm(own)


@pytest.mark.slow
def test_fibres_along_one_pull_are_within_two_spreads_equibiaxially():
    fibres = {"fibre_x": -0.6, "fibre_y": 0.0, "logit_dispersion": -3.0}
    data, true = observed(("fibre",), tuple(fibres.items()))
    found = of_parts(data, SETTINGS, "pull").found
    laws = open_laws(found, SETTINGS, OPEN_SAMPLES, 0)
    right = stress(ConvexBasis(("fibre",), SCALE), true)
    own = stress(found.basis, found.by_parts[:, 0, 0])
    error = np.linalg.norm(own - right) / np.linalg.norm(own)
    assert error > 0.05, "the pull tells the equibiaxial stress, so that nothing is tested"
    assert error <= 2.0 * doubt(found, laws)


def test_a_law_with_a_volume_is_compared_where_the_test_decides():
    assert "J" in terms_left(("I1_squared",), SETTINGS)
    assert "J" not in terms_left(("I1_squared",), SETTINGS.model_copy(update={"volume": "kept"}))
    assert "I2" not in terms_left(("J",), Constrained(terms=["I1_squared", "I2"]))


def test_a_law_with_a_volume_is_not_sought_where_one_of_I1_explains_the_test():
    sought = []

    def search(settings):
        sought.append(settings.terms)
        return of_parts(data, settings, "pull")

    data, _ = observed(())
    found = of_either(SETTINGS, search, cells=None)
    assert "J" not in found.basis.terms and sought == [SETTINGS.terms]
    assert not any("volume" in row["move"] for row in found.trace.rows(found.trial))


@pytest.mark.slow
def test_a_sheet_that_changes_its_volume_is_found_to():
    area = {"log1p_J_area": np.log1p(0.8), "log1p_J_volume": np.log1p(0.2)}
    data, true = observed(("J",), tuple(area.items()), make_load("biaxial", [[1.06, 1.03], [1.12, 1.06], [1.2, 1.1]]))
    found = of_either(SETTINGS, lambda settings: of_parts(data, settings, "sheet"), cells=None)
    assert "J" in found.basis.terms
    right = stress(found.basis, true)
    assert np.linalg.norm(stress(found.basis, found.by_parts[:, 0, 0]) - right) < 0.03 * np.linalg.norm(right)


@pytest.mark.parametrize(("keeps_volume", "sought"), [(False, 2), (True, 1)])
def test_laws_with_a_volume_are_not_sought_again_where_they_were_far_off(keeps_volume, sought):
    laws = []
    cells = SimpleNamespace(underfitted=False)

    def search(settings):
        laws.append(settings.terms)
        return Parts(None, keeps_volume)

    assert of_either(SETTINGS, search, lambda settings: cells) is cells
    assert len(laws) == sought


def test_forces_that_no_law_with_a_volume_gives_are_no_reason_against_other_laws():
    cells = SimpleNamespace(underfitted=True)

    def search(settings):
        if "J" in settings.terms:
            raise ImpossibleForcesError("no sheet gives them")
        return Parts(None, False)

    def in_cells(settings):
        search(settings)
        return cells

    assert of_either(SETTINGS, search, in_cells) is cells


@pytest.mark.parametrize(("volume", "terms"), [("kept", ["I1_squared"]), ("told", ["J"])])
def test_nothing_is_compared_that_is_not_asked_for(volume, terms):
    assert with_area(Constrained(terms=terms, volume=volume)) is None


def tried(terms, misfit, start=None):
    return SimpleNamespace(terms=terms, misfits={"displacement": misfit}, start=start)


@pytest.mark.parametrize(("left", "refuted"), [(1.95, False), (2.5, True)])
def test_another_volume_is_refuted_only_by_what_it_leaves_against_the_law_that_it_stood_against(left, refuted):
    coarse = tried(("I2",), 1.95)
    begun = tried(("J",), left + 0.1, coarse)
    other, finer = tried(("J",), left, begun), tried(("I2",), 1.0, coarse)
    found = SimpleNamespace(
        trace=SimpleNamespace(reasons=[coarse, begun, other, finer]), left=SimpleNamespace(independent=200.0)
    )
    assert laws_left_open._volume_refuted(found) is refuted
    found.trace.reasons = [coarse, finer]
    assert not laws_left_open._volume_refuted(found)
