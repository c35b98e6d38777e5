"""An identified sheet in felupe, pulled in a way that the test has not seen.

    hypernode export results/CASE/METHOD FOLDER --to numpy --to vtu
    python docs/examples/felupe_sheet.py FOLDER 1.1

Needs felupe and meshio, and nothing of hypernode: material.py of FOLDER is the material, sheet.vtu the mesh.
"""

import importlib.util
import sys
from pathlib import Path

import felupe as fem
import meshio
import numpy as np


def load_material(folder):
    """The module material.py of an exported folder."""
    spec = importlib.util.spec_from_file_location("material", Path(folder) / "material.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def umat(material, X):
    """The exported material for felupe, whose arrays have quadrature points and cells last: F[i, J, q, c].

    Args:
        material: has stress(X, F) and tangent(X, F) of points (n, 2) and (n, 2, 2).
        X: position of every cell at which its material is taken (c, 2).
    """

    def at_points(function, F):
        q = F.shape[2]
        points = np.moveaxis(F.reshape(2, 2, -1), -1, 0)
        found = function(np.tile(X, (q, 1)), points)
        return np.moveaxis(found, 0, -1).reshape(*found.shape[1:], q, len(X))

    def stress(x, **kwargs):
        return [at_points(material.stress, x[0]), x[-1]]

    def elasticity(x, **kwargs):
        return [at_points(material.tangent, x[0])]

    return fem.Material(stress, elasticity)


def sheet(material, nodes, cells):
    """(field, body) of the sheet in plane stress, whose cells have the material at their centres; thickness one."""
    region = fem.RegionQuad(fem.Mesh(nodes, cells, "quad"))
    # Two components and no third direction: the material is that of a sheet in plane stress already.
    field = fem.FieldContainer([fem.Field(region, dim=2)])
    return field, fem.SolidBody(umat(material, nodes[cells].mean(axis=1)), field)


def solve(field, body, held, values):
    """(u (node, 2), force (node, 2) that holds it) in equilibrium.

    Args:
        held: which displacement components are prescribed (node, 2).
        values: what they are (node, 2).
    """
    where = held.ravel()
    dof0, dof1 = np.flatnonzero(where), np.flatnonzero(~where)
    fem.newtonraphson(items=[body], x0=field, dof0=dof0, dof1=dof1, ext0=values.ravel()[dof0], tol=1e-10, verbose=False)
    force = body.assemble.vector(field).toarray().reshape(-1, 2)
    return field[0].values.copy(), force


def pulled_along_x(nodes, stretch):
    """(held, values) of a sheet whose left and right edges are clamped and pulled apart."""
    x = nodes[:, 0]
    left, right = x == x.min(), x == x.max()
    values = np.zeros_like(nodes)
    values[right, 0] = (stretch - 1.0) * np.ptp(x)
    return np.repeat((left | right)[:, None], 2, axis=1), values


def main(folder, stretch):
    """Pull the sheet to a stretch in five steps and print the force by thickness."""
    material, grid = load_material(folder), meshio.read(Path(folder) / "sheet.vtu")
    nodes, cells = grid.points[:, :2], grid.cells_dict["quad"]
    field, body = sheet(material, nodes, cells)
    for s in np.linspace(1.0, stretch, 6)[1:]:
        held, values = pulled_along_x(nodes, s)
        _, force = solve(field, body, held, values)
        right = nodes[:, 0] == nodes[:, 0].max()
        print(f"stretch {s:.4g}: force over thickness {force[right, 0].sum():.6g}")


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
