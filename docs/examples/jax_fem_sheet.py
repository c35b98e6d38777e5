"""An identified sheet in JAX-FEM, pulled in a way that the test has not seen.

    python docs/examples/jax_fem_sheet.py results/CASE/METHOD/material.nc 1.1

``hypernode.fem.solver.EquilibriumSolver`` is a ``Problem`` of JAX-FEM with a Newton's method that needs no PETSc. In a
``Problem`` of one's own, ``law`` is what ``get_tensor_map`` returns, ``lambda grad_u, *leaves: law(grad_u + eye(2),
unflatten(structure, leaves))``, and ``internal_vars`` are the leaves, by cell and quadrature point.
"""

import sys

import jax
import numpy as np

import hypernode
from hypernode.data.measurement import mesh_of
from hypernode.fem.solver import EquilibriumSolver
from hypernode.mechanics.loads import make_load
from hypernode.storage.netcdf import read


def solver_of(material, mesh):
    """The solver of a sheet whose cells have the material at their centres; thickness one."""
    law, values = material.point_law(mesh.centres)
    leaves, structure = jax.tree.flatten(values)
    named = {str(k): np.asarray(leaf, float) for k, leaf in enumerate(leaves)}
    return EquilibriumSolver(mesh, lambda F, p: law(F, jax.tree.unflatten(structure, list(p.values()))), named)


def main(path, stretch):
    """Pull the sheet along x between clamps to a stretch in five steps and print the force by thickness."""
    jax.config.update("jax_enable_x64", True)
    material, mesh = hypernode.load_material(path), mesh_of(read(path))
    solver, load = solver_of(material, mesh), make_load("clamped_x", np.linspace(1.0, stretch, 6)[1:])
    for u, s in zip(solver.solve(load)[0], load.stretch, strict=True):
        print(f"stretch {s:.4g}: force over thickness {solver.edge_forces(u, load)[('right', 0)]:.6g}")


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
