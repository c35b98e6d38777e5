"""A material as one Python file that needs NumPy alone, and the file of its numbers."""

import ast
import importlib
import inspect
import io
import json

import numpy as np
import xarray as xr

from hypernode.material.basis_file import basis_field
from hypernode.material.domain_file import domain_of
from hypernode.material.files import lines_of, node_material
from hypernode.material.laws import ENERGY_POINTS
from hypernode.networks.terms import TERMS

#: Kind of a material -> the modules that its file is made of, in their order.
_PARTS = "hypernode.export.numpy_material"
SECTIONS = {
    "closed_form": (f"{_PARTS}.mechanics", f"{_PARTS}.cells", f"{_PARTS}.closed_form"),
    "convex_basis": (f"{_PARTS}.mechanics", f"{_PARTS}.cells", "hypernode.material.lines", f"{_PARTS}.basis"),
    "node": (f"{_PARTS}.mechanics", f"{_PARTS}.potentials", f"{_PARTS}.node"),
}
#: What every file begins with, after its title, and ends with.
HEAD = '''"""{title}: stress, tangent and energy at any position and deformation.

    import material

    P = material.stress(X, F)  # first Piola-Kirchhoff stress (n, 2, 2) [{stress}]
    A = material.tangent(X, F)  # dP/dF (n, 2, 2, 2, 2)
    W = material.energy(X, F)  # energy density (n,)

for positions X (n, 2) [{length}] and in-plane deformation gradients F (n, 2, 2) of a sheet in plane stress. The numbers
are in material.npz beside this file. Written by hypernode, and under its licence, GPL-3.0-or-later.
"""
'''
TAIL = """
MATERIAL = Material(np.load(Path(__file__).with_name("material.npz")), LAW)
units, seen = MATERIAL.units, MATERIAL.seen
stress, tangent, energy = MATERIAL.stress, MATERIAL.tangent, MATERIAL.energy
"""


def numpy_package(file: xr.Dataset) -> dict[str, bytes]:
    """{name: content} of ``material.py`` and ``material.npz``, of an opened file that holds a material of any kind."""
    kind = file.attrs["material_kind"]
    arrays, spec = {"closed_form": _closed_form, "convex_basis": _convex_basis, "node": _node}[kind](file)
    domain, units = domain_of(file), json.loads(file.attrs["units"])
    spec |= {"units": units, "seen": domain.ranges if domain else None}
    content = io.BytesIO()
    np.savez(content, spec=np.array(json.dumps(spec)), **arrays)
    text = _assembled(kind, HEAD.format(title=file.attrs["title"].capitalize(), **units))
    return {"material.py": text.encode(), "material.npz": content.getvalue()}


def _assembled(kind: str, head: str) -> str:
    """The text of the Python file: its sections without what they import of one another."""
    # The law comes last in the section of its kind, and needs the class of laws.
    names = ["hypernode.material.domain", f"{_PARTS}.api", *SECTIONS[kind]]
    imports, bodies = {"from pathlib import Path"}, []
    for name in names:
        source = inspect.getsource(importlib.import_module(name))
        tree, lines = ast.parse(source), source.splitlines()
        for node in tree.body:
            docstring = node is tree.body[0]
            imported = isinstance(node, (ast.Import, ast.ImportFrom))
            if imported and not (getattr(node, "module", None) or "").startswith("hypernode"):
                imports.add(ast.get_source_segment(source, node))
            if imported or docstring:
                lines[node.lineno - 1 : node.end_lineno] = [None] * (node.end_lineno - node.lineno + 1)
        about = [f"# {line}".rstrip() for line in ast.get_docstring(tree).splitlines()]
        body = "\n".join(line for line in lines if line is not None).strip()
        bodies.append("\n".join([*about, "", body]))
    # As import sorters have it: whole modules, then names of modules.
    ordered = sorted(imports - {"import numpy as np"}, key=lambda line: (line.startswith("from"), line))
    return "\n".join([head, *ordered, "", "import numpy as np", ""]) + "\n\n".join(["", *bodies]) + "\n\n" + TAIL


def _cells(file: xr.Dataset) -> dict[str, np.ndarray]:
    """The lines on which the centres of the cells lie, and which cell is where they cross."""
    centres = file["X"].values[file["cells"].values].mean(axis=1)
    (x, column), (y, row) = (np.unique(centres[:, k], return_inverse=True) for k in range(2))
    cell_at = np.full((len(y), len(x)), -1)
    cell_at[row, column] = np.arange(len(centres))
    return {"centre_x": x, "centre_y": y, "cell_at": cell_at}


def _closed_form(file: xr.Dataset):
    arrays = {name: file[name].values for name in file if name.startswith("material.")}
    spec = {"models": json.loads(file.attrs["models"]), "parameters": [name.split(".", 1)[1] for name in arrays]}
    return arrays | _cells(file), spec


def _convex_basis(file: xr.Dataset):
    basis, params = basis_field(file)
    coefficients = {letter: np.asarray(value) for letter, value in basis.coefficients(params).items()}
    return coefficients | _cells(file) | (lines_of(file) or {}), {
        "letters": list(coefficients),
        "invariant_scale": basis.invariant_scale,
    }


def _node(file: xr.Dataset):
    material = node_material(file)
    layers = len(json.loads(file.attrs["hypernetwork"])["widths"]) + 1
    arrays = {"frequencies": file["hypernetwork.frequencies"].values, "lower": file["corners"].values[0]}
    for k in range(layers):
        arrays |= {f"{name}.{k}": file[f"hypernetwork.layers.{k}.{name}"].values for name in ("kernel", "bias")}
    spec = {
        "terms": [list(TERMS[term]) for term in material.terms],
        "hidden": list(material.hidden),
        "weights_per_term": material.weights_per_term,
        "layers": layers,
        "length_scale": float(file.attrs["length_scale"]),
        "energy_points": ENERGY_POINTS,
    }
    same = ("steps", "invariant_scale", "stress_scale", "share", "scaled", "potential")
    return arrays, spec | {name: getattr(material, name) for name in same}
