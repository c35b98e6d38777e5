"""Stage 8: the pre-trained hyper-network, brought to explain displacements and forces in its own equilibrium."""

import json

import numpy as np

from hypernode.config.methods import Method
from hypernode.data.measurement import mesh_of
from hypernode.fem.gradient import deformation_gradient
from hypernode.identification.problem import FieldProblem, problem_of_basis
from hypernode.material.files import node_material
from hypernode.material.node_law import NodeLaw
from hypernode.polishing.polish import Polished, polish
from hypernode.polishing.weight_field import WeightField
from hypernode.stages.as_identified import problem_as_identified
from hypernode.stages.hypernetwork_files import open_problem, save
from hypernode.training.loop import Fit


def run(method: Method, name: str, files: dict[str, str], output: str, attributes: dict) -> None:
    """Polish the hyper-network of one case and write it, or the pre-trained one where that is as good.

    Args:
        files: paths of ``measurement``, ``field``, ``homogenised``, ``constrained`` and ``previous``, see
            :class:`~hypernode.training.problem.InverseProblem`.
    """
    inverse = open_problem(method, name, files)
    measurement, constrained = inverse.inputs["measurement"], inverse.inputs["constrained"]
    mesh, (params, apply) = mesh_of(measurement), inverse.trainable()
    field = WeightField(apply(params), (mesh.centres - mesh.lower) / inverse.length)
    problem = _problem(measurement, constrained, method, NodeLaw(node_material(inverse.inputs["previous"])))
    found = polish(problem, field, method.constrained, method.polish, list(constrained["u"].values), name)
    fit = Fit(field.network(found.weights), found.history, np.arange(len(found.history)))
    save(inverse, fit, "polished hyper-network", files, output, attributes, *_content(mesh, found))


def _problem(measurement, constrained, method: Method, law: NodeLaw) -> FieldProblem:
    """The test with the noise model of the equilibrium field, on the measured grid, whose cells the network knows.

    A field that is finer describes the test better than undivided cells do, and these have an error of their own.
    """
    if constrained.sizes["subcell"] > 1:
        return problem_of_basis(measurement, method.constrained, law)
    return problem_as_identified(measurement, constrained, method.constrained, law, 1)[0]


def _content(mesh, found: Polished) -> tuple[dict, dict]:
    """(variables, attributes) of what became of the network."""
    variables = {"held_out": found.held_out.astype(int)}
    if found.kept:
        variables |= {"u": found.u, "F": deformation_gradient(mesh, found.u)}
    polished = {"kept": found.kept, "reason": found.reason, "misfits": found.misfits}
    return variables, {"polished": json.dumps(polished | {"ending": found.ending and str(found.ending)})}
