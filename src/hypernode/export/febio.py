"""A model of FEBio whose material parameters are maps: one value an element.

Mesh, material and maps after version 4.0 of FEBio's input format; boundary conditions and steps are the user's.
"""

import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hypernode.export.choice import Candidate
from hypernode.export.curves import Curves, stacked
from hypernode.export.fitting import fit
from hypernode.export.laws import ExportedLaw
from hypernode.export.run import Run

#: Bulk modulus of a nearly incompressible solid over its shear modulus.
BULK = 1e3
#: Name of the elements, of their material and of the file.
PART = "sheet"


@dataclass(frozen=True)
class Translation:
    """A law in FEBio's words.

    Attributes:
        type: of the material.
        parameters: parameters of the law -> {name in FEBio: value}.
        shear: parameters of the law -> shear modulus, of a law of a nearly incompressible solid.
    """

    type: str
    parameters: Callable[[Mapping], Mapping]
    shear: Callable[[Mapping], np.ndarray] | None = None


def _young(p):
    mu, la = p["mu"], p["lambda"]
    return {"E": mu * (3.0 * la + 2.0 * mu) / (la + mu), "v": 0.5 * la / (la + mu)}


def _goh(p):
    # FEBio has two families at +-gamma: at zero they are one family of twice the strength.
    return {"c": 2.0 * p["C10"], "k1": 0.5 * p["k1"], "k2": p["k2"], "kappa": p["kappa"]}


#: Laws that FEBio has with a value for every element.
TRANSLATIONS = {
    "neo-Hookean": Translation(
        "Mooney-Rivlin", lambda p: {"c1": 0.5 * p["mu"], "c2": 0.0 * p["mu"]}, lambda p: p["mu"]
    ),
    "Mooney-Rivlin": Translation(
        "Mooney-Rivlin", lambda p: {"c1": p["C10"], "c2": p["C01"]}, lambda p: 2.0 * (p["C10"] + p["C01"])
    ),
    "Yeoh": Translation("Yeoh", lambda p: {"c1": p["C10"], "c2": p["C20"], "c3": p["C30"]}, lambda p: 2.0 * p["C10"]),
    "compressible neo-Hookean": Translation("neo-Hookean", _young),
    "Gasser-Ogden-Holzapfel": Translation("Holzapfel-Gasser-Ogden", _goh, lambda p: 2.0 * p["C10"]),
}


def febio_files(run: Run, laws: list[tuple[Curves, list[Candidate]]]) -> dict[str, bytes]:
    """{name: content} of ``sheet.feb``: one law for the whole sheet, its parameters fitted in every element."""
    law = common_law(laws)
    parameters = cell_parameters(run, law, laws)
    root = ET.Element("febio_spec", version="4.0")
    root.append(ET.Comment(_remark(run, law)))
    ET.SubElement(root, "Module", type="solid")
    _material(root, law, parameters)
    _mesh(root, run)
    domains = ET.SubElement(root, "MeshDomains")
    ET.SubElement(domains, "SolidDomain", name=PART, mat=PART)
    _maps(root, law, parameters)
    ET.indent(root)
    return {"sheet.feb": ET.tostring(root, encoding="utf-8", xml_declaration=True) + b"\n"}


def common_law(laws: list[tuple[Curves, list[Candidate]]]) -> ExportedLaw:
    """The law that FEBio has and that is the best for all phases together."""
    total: dict[str, float] = {}
    for _, found in laws:
        for each in found:
            total[each.law.name] = total.get(each.law.name, 0.0) + each.criterion
    best = min(TRANSLATIONS, key=lambda name: total[name])
    return next(each.law for each in laws[0][1] if each.law.name == best)


def cell_parameters(run: Run, law: ExportedLaw, laws) -> dict[str, Float[np.ndarray, " cell"]]:
    """{parameter: value of every cell} of a law, fitted to the stresses of each cell from what its phase has."""
    F, _, noise, stiffness = stacked([curves for curves, _ in laws])
    count = len(run.mesh.cells)
    phase, starts = np.empty(count, int), np.empty((count, len(law.names)))
    stress = np.zeros((count, *noise.shape[1:]))
    for k, (curves, found) in enumerate(laws):
        phase[curves.cells] = k
        starts[curves.cells] = next(each.params for each in found if each.law.name == law.name)
        stress[curves.cells, : len(curves.F)] = curves.by_cell
    params = fit(law, F[phase], stress, noise[phase], starts, stiffness[phase]).params
    return dict(zip(law.names, params.T, strict=True))


def _remark(run: Run, law: ExportedLaw) -> str:
    units = run.material.units
    remark = (
        f" {run.name}, written by hypernode: {law.name}, W = {law.formula}, fitted in every element. "
        f"Lengths in {units['length']}, stresses in {units['stress']}; {len(run.mesh.cells)} elements in the order of "
        f"the cells, one through the thickness. Verdict on the run: {run.verdict.label}. Add boundary conditions. "
    )
    # Two hyphens would end the comment.
    return remark.replace("--", "- -")


def _material(root, law: ExportedLaw, parameters) -> None:
    translation = TRANSLATIONS[law.name]
    material = ET.SubElement(ET.SubElement(root, "Material"), "material", id="1", name=PART, type=translation.type)
    for name in translation.parameters(parameters):
        ET.SubElement(material, name, type="map").text = name
    if translation.shear is not None:
        ET.SubElement(material, "k").text = repr(float(BULK * np.median(translation.shear(parameters))))
    if "fibre_angle" in parameters:
        ET.SubElement(material, "gamma").text = "0"


def _mesh(root, run: Run) -> None:
    """The cells as one layer of hexahedra between z = 0 and the sheet's mean thickness."""
    mesh = ET.SubElement(root, "Mesh")
    nodes, count = ET.SubElement(mesh, "Nodes", name=PART), len(run.mesh.nodes)
    for layer, z in enumerate((0.0, float(np.average(run.thickness, weights=run.mesh.areas)))):
        for number, (x, y) in enumerate(run.mesh.nodes, start=1 + layer * count):
            ET.SubElement(nodes, "node", id=str(number)).text = f"{float(x)!r},{float(y)!r},{z!r}"
    elements = ET.SubElement(mesh, "Elements", type="hex8", name=PART)
    for number, cell in enumerate(run.mesh.cells + 1, start=1):
        corners = [*cell.tolist(), *(cell + count).tolist()]
        ET.SubElement(elements, "elem", id=str(number)).text = ",".join(map(str, corners))


def _maps(root, law: ExportedLaw, parameters) -> None:
    data = ET.SubElement(root, "MeshData")
    for name, values in TRANSLATIONS[law.name].parameters(parameters).items():
        entry = ET.SubElement(data, "ElementData", name=name, elem_set=PART)
        for number, value in enumerate(values, start=1):
            ET.SubElement(entry, "e", lid=str(number)).text = repr(float(value))
    if "fibre_angle" in parameters:
        entry = ET.SubElement(data, "ElementData", type="mat_axis", elem_set=PART)
        for number, angle in enumerate(np.deg2rad(parameters["fibre_angle"]), start=1):
            c, s = float(np.cos(angle)), float(np.sin(angle))
            element = ET.SubElement(entry, "e", lid=str(number))
            ET.SubElement(element, "a").text = f"{c!r},{s!r},0"
            ET.SubElement(element, "d").text = f"{-s!r},{c!r},0"
