"""An identified sheet does the same in felupe and in JAX-FEM, under a load that was not in the test."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from hypernode.fem.mesh import rectilinear
from hypernode.material.files import material_of
from hypernode.mechanics.loads import make_load
from tests.export.materials import MESH, basis_file, closed_form_file, exported, node_file

pytest.importorskip("felupe", reason="needs felupe: make felupe")
EXAMPLES = Path(__file__).resolve().parents[2] / "docs/examples"
#: Same mesh, same elements, same material: what is left is where Newton's methods end.
AGREE = 1e-6
KINDS = {
    "basis": lambda: basis_file(("I1_squared", "I2", "fibre"), subcells=2),
    "compressible basis": lambda: basis_file(("J", "I1_squared"), subcells=1),
    "closed forms": closed_form_file,
    "network": lambda: node_file(("I1", "I2", "I1_I4v")),
}


def module(name):
    """An example, imported."""
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


@pytest.fixture(scope="module")
def example():
    return module("felupe_sheet")


@pytest.mark.parametrize("kind", KINDS)
def test_displacements_and_forces_agree_under_an_unseen_load(kind, example, tmp_path):
    file, load = KINDS[kind](), make_load("clamped_x", [1.08, 1.15])
    solver = module("jax_fem_sheet").solver_of(material_of(file), MESH)
    wanted, _ = solver.solve(load)
    field, body = example.sheet(exported(file, tmp_path), MESH.nodes, MESH.cells)
    for stretch, u in zip(load.stretch, wanted, strict=True):
        found, force = example.solve(field, body, *example.pulled_along_x(MESH.nodes, stretch))
        assert np.abs(found - u).max() < AGREE * np.abs(u).max()
        reaction = solver.internal_force(u)
        assert np.abs(force - reaction).max() < AGREE * np.abs(reaction).max()
    right = MESH.on_edge("right")
    assert force[right, 0].sum() == pytest.approx(solver.edge_forces(u, load)[("right", 0)], rel=AGREE)


def test_the_example_prints_the_forces_of_an_exported_folder(example, tmp_path, capsys):
    import meshio

    exported(basis_file(()), tmp_path)
    mesh = rectilinear(np.linspace(0.0, 2.0, 4), np.linspace(1.0, 2.5, 4))
    meshio.Mesh(np.pad(mesh.nodes, ((0, 0), (0, 1))), [("quad", mesh.cells)]).write(tmp_path / "sheet.vtu")
    example.main(tmp_path, 1.1)
    lines = capsys.readouterr().out.splitlines()
    forces = [float(line.rsplit(" ", 1)[1]) for line in lines]
    assert len(lines) == 5 and lines[-1].startswith("stretch 1.1:") and (np.diff(forces) > 0.0).all()
