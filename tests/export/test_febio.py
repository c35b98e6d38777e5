"""FEBio's words for a law are the law, and every element has the parameters of its cell."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from hypernode.commands.export import open_run
from hypernode.export.febio import BULK, TRANSLATIONS, febio_files
from hypernode.export.laws import LAWS
from hypernode.export.numpy_material.mechanics import invariants
from hypernode.export.table import phase_laws, table_files
from tests.export.runs import MESH, MU, PHASE, SPREAD, THICKNESS, write_run
from tests.export.test_laws import TRUE

F = np.eye(2) + 0.2 * np.random.default_rng(0).normal(size=(20, 2, 2))
J, C = np.linalg.det(F), np.swapaxes(F, 1, 2) @ F
#: Invariants of the incompressible solid.
I1 = np.trace(C, axis1=1, axis2=2) + J**-2
I2 = J**2 + np.trace(C, axis1=1, axis2=2) / J**2


def mooney_rivlin(p):
    return p["c1"] * (I1 - 3.0) + p["c2"] * (I2 - 3.0)


def yeoh(p):
    return sum(p[f"c{n}"] * (I1 - 3.0) ** n for n in (1, 2, 3))


def holzapfel_gasser_ogden(p, angle=30.0):
    """Two families at +-gamma = 0 from the first material axis."""
    a = np.array([np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))])
    E = p["kappa"] * (I1 - 3.0) + (1.0 - 3.0 * p["kappa"]) * (np.einsum("i,nij,j->n", a, C, a) - 1.0)
    return 0.5 * p["c"] * (I1 - 3.0) + 2 * 0.5 * p["k1"] / p["k2"] * np.expm1(p["k2"] * np.maximum(E, 0.0) ** 2)


#: Energies of the materials of FEBio, by their type.
FEBIO = {"Mooney-Rivlin": mooney_rivlin, "Yeoh": yeoh, "Holzapfel-Gasser-Ogden": holzapfel_gasser_ogden}


@pytest.mark.parametrize(
    "law", [law for law in LAWS if law.name in TRANSLATIONS and law.name[0] != "c"], ids=lambda law: law.name
)
def test_the_energy_in_the_words_of_febio_is_that_of_the_law(law):
    p = dict(zip(law.names, TRUE[law.name], strict=True))
    translation = TRANSLATIONS[law.name]
    wanted, _ = law.response(invariants(np.moveaxis(F, 0, -1), np.deg2rad(30.0)), p)
    np.testing.assert_allclose(FEBIO[translation.type](translation.parameters(p)), wanted, rtol=1e-12)


def test_young_and_poisson_are_those_of_lame():
    p = TRANSLATIONS["compressible neo-Hookean"].parameters({"mu": 0.7, "lambda": 1.4})
    assert p["E"] / (2.0 * (1.0 + p["v"])) == pytest.approx(0.7, rel=1e-14)
    assert p["E"] * p["v"] / ((1.0 + p["v"]) * (1.0 - 2.0 * p["v"])) == pytest.approx(1.4, rel=1e-14)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return open_run(write_run(tmp_path_factory.mktemp("results"), "skin--1"))


@pytest.fixture(scope="module")
def laws(run):
    return phase_laws(run)


def test_every_element_has_the_parameters_of_its_cell(run, laws):
    root = ET.fromstring(febio_files(run, laws)["sheet.feb"])
    (material,) = root.find("Material")
    assert material.get("type") == "Mooney-Rivlin" and material.find("c1").get("type") == "map"
    assert float(material.find("k").text) == pytest.approx(BULK * np.median(MU[PHASE]), rel=1e-6)
    maps = {each.get("name"): each for each in root.find("MeshData")}
    assert set(maps) == {each.text for each in material if each.get("type") == "map"}
    assert [int(each.get("lid")) for each in maps["c1"]] == list(range(1, len(PHASE) + 1))
    np.testing.assert_allclose([float(each.text) for each in maps["c1"]], 0.5 * MU[PHASE], rtol=1e-6)
    assert {each.get("elem_set") for each in maps.values()} == {root.find("Mesh/Elements").get("name")}


def test_elements_are_the_cells_as_thick_as_the_sheet(run, laws):
    root = ET.fromstring(febio_files(run, laws)["sheet.feb"])
    nodes = np.array([[float(x) for x in each.text.split(",")] for each in root.find("Mesh/Nodes")])
    elements = np.array([[int(n) for n in each.text.split(",")] for each in root.find("Mesh/Elements")]) - 1
    np.testing.assert_array_equal(nodes[elements[:, :4], :2], MESH.nodes[MESH.cells])
    np.testing.assert_array_equal(nodes[elements[:, 4:], :2], MESH.nodes[MESH.cells])
    np.testing.assert_allclose(nodes[elements, 2], np.tile(np.repeat([0.0, THICKNESS], 4), (len(PHASE), 1)), rtol=1e-14)


def test_the_table_says_law_parameters_and_deviations_of_every_phase(run, laws):
    for (curves, found), mu in zip(laws, MU, strict=True):
        assert found[0].law.name == "neo-Hookean"
        assert found[0].params[0] == pytest.approx(mu, rel=1e-9)
        # To first order in the sample, as the posterior material is.
        assert found[0].deviation[0] == pytest.approx(SPREAD * mu, rel=1e-6)
        assert set(curves.modes) == {"test", "equibiaxial", "strip_x", "strip_y"} and len(curves.F) == 12
    files = table_files(run, laws)
    page, rows = files["laws.md"].decode(), files["laws.csv"].decode().splitlines()
    assert "## Phase 1: neo-Hookean" in page and "| mu | 1.2 | 0.024 | MPa |" in page and "warn: forces" in page
    assert rows[0].startswith("phase,rank,law,parameter,value,standard_deviation,unit,misfit")
    assert rows[1].startswith("0,0,neo-Hookean,mu,0.6") and "No law of these" not in page
