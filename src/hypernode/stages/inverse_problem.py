"""What the three hyper-network stages share: data on the grid, the network, its file."""

import dataclasses
import json

import jax
import jax.numpy as jnp
import numpy as np

from hypernode.config import Frequencies, Method
from hypernode.material import node_stress
from hypernode.mechanics.equilibrium import EquilibriumGap
from hypernode.mechanics.mesh import Mesh
from hypernode.networks.node_material import NodeMaterial
from hypernode.networks.weights import from_arrays, make_network, split_trainable, to_arrays
from hypernode.stages.fields import Loading, mesh_of
from hypernode.stages.interpolant import InterpolatedGradient
from hypernode.storage.netcdf import read, units_of, write


@dataclasses.dataclass
class InverseProblem:
    """The measured grid with the interpolated F on it, and a hyper-network to be trained.

    Attributes:
        mesh: the measured grid; ``X`` are its cell centres scaled to the longest side (cell, 2).
        F: interpolated deformation gradient at the centres [i, J, step, cell].
        gaps: one equilibrium measure a test.
        centre: homogenised parameters, about which the prior is centred.
    """

    name: str
    mesh: Mesh
    X: jax.Array
    F: jax.Array
    loading: Loading
    interpolated: InterpolatedGradient
    node: NodeMaterial
    centre: jax.Array
    length: float
    units: dict
    hypernetwork: str

    @classmethod
    def load(cls, method: Method, name: str, measurement_file: str, interpolant_file: str, homogenised_file: str):
        """Assemble from the files of the earlier stages."""
        measurement, homogenised = read(measurement_file), read(homogenised_file)
        interpolated = InterpolatedGradient(file := read(interpolant_file))
        mesh, length = mesh_of(measurement), float(file.attrs["length_scale"])
        spec = {k: tuple(v) if isinstance(v, list) else v for k, v in json.loads(homogenised.attrs["node"]).items()}
        return cls(
            name,
            mesh,
            jnp.asarray((mesh.centres - mesh.lower) / length, jnp.float32),
            interpolated(jnp.asarray(mesh.centres, jnp.float32)),
            Loading.of(measurement),
            interpolated,
            NodeMaterial(**spec),
            jnp.asarray(homogenised["node_params"].values, jnp.float32),
            length,
            units_of(measurement),
            method.hypernetwork.model_dump_json(include=set(Frequencies.model_fields)),
        )

    @property
    def scale(self):
        """Stress unit of each step (step,)."""
        return jnp.asarray(self.loading.scale, jnp.float32)

    def new_network(self, seed: int):
        """A hyper-network with random weights; its width follows from the NODE architecture."""
        return make_network(Frequencies.model_validate_json(self.hypernetwork), 0, self.node.size, seed)

    def trainable(self, file: str):
        """(params, params -> network) of the network stored by an earlier stage."""
        return split_trainable(from_arrays(self.new_network(0), read(file), "hypernetwork"))

    def stress(self, node_params):
        """P[i, J, step, cell] at the measured deformation."""
        return node_stress(self.node, self.F, node_params)

    def gaps(self):
        """(steps, :class:`EquilibriumGap`) of each test."""
        loading = self.loading
        return [
            (
                np.flatnonzero(loading.test == k),
                EquilibriumGap.build(self.mesh, loading.constrained[k], loading.known[k]),
            )
            for k in range(loading.test.max() + 1)
        ]

    def save(self, output, network, history, title, attributes, parents) -> None:
        """Write the network with everything :func:`hypernode.load_material` needs."""
        losses, iterations = history
        write(
            output,
            {
                **to_arrays(network, "hypernetwork"),
                "X": self.mesh.nodes,
                "cells": self.mesh.cells,
                "corners": np.stack([self.mesh.lower, self.mesh.upper]),
                "loss": losses,
                "loss_iteration": iterations,
            },
            f"{title} of {self.name}",
            {
                **attributes,
                "units": self.units,
                "material_kind": "node",
                "node": json.dumps(dataclasses.asdict(self.node)),
                "hypernetwork": self.hypernetwork,
                "length_scale": self.length,
            },
            parents=parents,
        )
