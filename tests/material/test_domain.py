"""A material knows what its test has seen, keeps it in its file, and warns beyond it once."""

import json
import warnings

import jax
import numpy as np
import pytest

from hypernode import load_material
from hypernode.material.domain import DIRECTIONS, ISOTROPIC, Domain, deformation_measures
from hypernode.material.domain_file import domain_content, domain_of
from tests.export.runs import LOAD, write_run
from tests.export.runs import MESH as SHEET

SEEN = np.array([np.diag([1.2, 1.0]), np.diag([1.1, 0.95]), np.diag([1.15, 1.1])])


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return write_run(tmp_path_factory.mktemp("results"))


def test_measures_are_those_of_the_deformation_and_do_not_see_a_rotation():
    F = np.array([[1.2, 0.3], [-0.1, 0.9]])
    c, s = np.cos(0.7), np.sin(0.7)
    measures, turned = deformation_measures(F), deformation_measures(np.array([[c, -s], [s, c]]) @ F)
    largest, smallest = np.linalg.svd(F, compute_uv=False)
    assert (measures["largest_stretch"], measures["smallest_stretch"]) == pytest.approx((largest, smallest), rel=1e-14)
    assert measures["area_ratio"] == pytest.approx(largest * smallest, rel=1e-14)
    assert measures["stretch_90"] == pytest.approx(np.linalg.norm(F @ [0.0, 1.0]), rel=1e-14)
    assert turned == pytest.approx(measures, rel=1e-13)


def test_a_domain_holds_its_test_and_the_undeformed_sheet_and_little_beyond():
    domain = Domain.of(SEEN, directional=False)
    assert domain.inside(SEEN).all() and domain.inside(np.eye(2)) and domain.remark(SEEN) == ""
    beyond = np.array([np.diag([1.21, 1.0]), np.diag([1.1, 0.94]), np.diag([1.2, 1.2]), np.diag([-1.0, 1.0])])
    assert not domain.inside(beyond).any()
    # Seen along another line, which only a material with a direction tells apart.
    turned = SEEN[0][::-1, ::-1]
    assert domain.inside(turned) and not Domain.of(SEEN, directional=True).inside(turned)
    assert tuple(domain.ranges) == ISOTROPIC
    assert tuple(Domain.of(SEEN, directional=True).ranges) == (*ISOTROPIC, *DIRECTIONS)


def test_folded_and_missing_deformations_are_no_part_of_a_domain():
    with_folds = np.concatenate([SEEN, [np.diag([-2.0, 1.0]), np.full((2, 2), np.nan)]])
    assert Domain.of(with_folds, directional=True).ranges == Domain.of(SEEN, directional=True).ranges


def test_the_remark_says_how_many_and_which_measure():
    domain = Domain.of(SEEN, directional=False)
    remark = domain.remark(np.stack([np.eye(2), np.eye(2), np.eye(2), np.diag([1.5, 1.0])]))
    assert remark.startswith("25.0 % of the deformations")
    assert remark.endswith("the largest stretch is 1.5, and in the test it was 1 to 1.2")


def test_a_domain_is_read_back_from_a_file(run):
    from hypernode.storage.netcdf import read

    file = read(run / "material.nc")
    wanted = Domain.of(LOAD.H + np.eye(2), directional=False).ranges
    found = domain_of(file).ranges
    assert list(found) == list(wanted)
    np.testing.assert_allclose(list(found.values()), list(wanted.values()), rtol=1e-14)
    variables, attributes = domain_content(domain_of(file))
    np.testing.assert_array_equal(variables["deformation_seen"], file["deformation_seen"].values)
    assert attributes["deformation_measures"] == json.loads(file.attrs["deformation_measures"])
    assert domain_of(file.drop_vars("deformation_seen")) is None


def test_a_loaded_material_warns_once_beyond_its_test_and_never_within(run):
    material, X = load_material(run / "material.nc"), SHEET.centres[:2]
    inside, outside = np.tile(np.diag([1.3, 1.15]), (2, 1, 1)), np.stack([np.eye(2), np.diag([1.4, 1.0])])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        material.stress(X, inside)
        jax.jvp(lambda F: material.stress(X, F), (outside,), (outside,))
    with pytest.warns(
        UserWarning, match=r"50\.0 % of .* the largest stretch is 1\.4, and in the test it was 1 to 1\.3"
    ):
        material.tangent(X, outside)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        material.energy(X, outside)


def test_the_law_of_a_point_is_that_of_the_field(run):
    material, X = load_material(run / "material.nc"), SHEET.centres
    F = np.eye(2) + np.random.default_rng(0).uniform(0.0, 1.0, (len(X), 1, 1)) * LOAD.H[-1]
    law, values = material.point_law(X)
    np.testing.assert_allclose(jax.vmap(law)(F, values), material.stress(X, F), rtol=1e-13)
