"""What the three hyper-network stages share: data on the grid, the network, its file."""

import dataclasses
import functools
import json
from collections.abc import Mapping

import jax
import jax.numpy as jnp
import numpy as np

from hypernode.config.methods import Frequencies, Method
from hypernode.data.loading import Loading
from hypernode.data.measurement import field_gradient, mesh_of
from hypernode.fem.equilibrium_gap import EquilibriumGap
from hypernode.fem.mesh import Mesh
from hypernode.material.basis_file import basis_field
from hypernode.material.laws import mean_of_subcells
from hypernode.mechanics.modes import mode_gradients
from hypernode.networks.fourier_mlp import FourierMLP
from hypernode.networks.node_material import NodeMaterial
from hypernode.networks.weights import from_arrays, make_network, split_trainable, to_arrays
from hypernode.storage.netcdf import read, units_of, write
from hypernode.training.targets import Target

#: Sizes of the homogeneous modes that pre-training learns, as shares of the largest stretch of the test.
MODE_SIZES = np.array([0.08, 0.5, 1.0])


#: Factor on the random kernel of a new network's last layer: small, so that the start is nearly homogeneous,
#: and not zero, so that gradients reach the layers below.
LAST_KERNEL = 0.01


@dataclasses.dataclass
class InverseProblem:
    """The measured grid with the interpolated F on it, and a hyper-network to be trained.

    Attributes:
        mesh: the measured grid; ``X`` are its cell centres scaled to the longest side (cell, 2).
        F: deformation gradient at the centres [i, J, step, cell]; ``variance`` is how uncertain it is in a cell, over
            the mean.
        gaps: one equilibrium measure a test.
        spec: fields of the neural-ODE material.
        centre: homogenised parameters, about which the prior is centred.
    """

    name: str
    mesh: Mesh
    X: jax.Array
    F: jax.Array
    variance: np.ndarray
    loading: Loading
    spec: dict
    centre: jax.Array
    length: float
    units: dict
    hypernetwork: str
    seed: int
    stretch: float
    files: Mapping[str, str]

    @classmethod
    def load(cls, method: Method, name: str, files: Mapping[str, str]):
        """Assemble from the files of the earlier stages.

        Args:
            files: ``measurement``, ``field`` (interpolant or gradient), ``homogenised``, and where the
                method has one ``constrained``.
        """
        measurement, homogenised, field = (read(files[key]) for key in ("measurement", "homogenised", "field"))
        mesh = mesh_of(measurement)
        length = float(mesh.size.max())
        spec = {k: tuple(v) if isinstance(v, list) else v for k, v in json.loads(homogenised.attrs["node"]).items()}
        return cls(
            name,
            mesh,
            jnp.asarray((mesh.centres - mesh.lower) / length, jnp.float32),
            jnp.asarray(field_gradient(field), jnp.float32),
            field["gradient_variance"].values,
            Loading.of(measurement),
            spec,
            jnp.asarray(homogenised["node_params"].values, jnp.float32),
            length,
            units_of(measurement),
            method.hypernetwork.model_dump_json(include=set(Frequencies.model_fields)),
            method.seed,
            float(measurement["stretch"].values.max()),
            files,
        )

    @functools.cached_property
    def node(self) -> NodeMaterial:
        """The material at a point, as training uses it."""
        return NodeMaterial(**self.spec).with_units_as_data()

    @property
    def scale(self):
        """Stress unit of each step (step,)."""
        return jnp.asarray(self.loading.scale, jnp.float32)

    @property
    def _architecture(self):
        """(settings, inputs beside the position, outputs) of the hyper-network."""
        return Frequencies.model_validate_json(self.hypernetwork), 0, self.node.size

    def _new_network(self) -> FourierMLP:
        """A hyper-network with random weights that gives nearly the homogenised parameters everywhere."""
        network = make_network(*self._architecture, self.seed + 1)
        last = network.layers[-1]
        last.bias[...] = self.centre
        last.kernel[...] = LAST_KERNEL * last.kernel[...]
        return network

    def trainable(self):
        """(params, params -> network) of what an earlier stage left, ``files["previous"]``, or else of a new one."""
        if "previous" in self.files:
            return split_trainable(from_arrays(*self._architecture, read(self.files["previous"]), "hypernetwork"))
        return split_trainable(self._new_network())

    def target(self) -> "Target":
        """What pre-training aims at: force over cross-section, or the stress of the constrained field.

        The constrained field also says what cells would do under deformations that they have not
        seen: homogeneous modes of the size of the test and of shares of it keep the networks from
        inventing an answer there. The smallest one fixes the stiffness of the undeformed sheet, where
        coarse steps of a neural ODE may leave a spike that stops Newton's method.
        """
        scale = self.loading.scale[:, None]
        if "constrained" not in self.files:
            P = np.moveaxis(self.loading.P_average, 0, -1)[..., None] / scale
            P = np.broadcast_to(P, self.F.shape)
            return Target(self.F, jnp.asarray(P, jnp.float32), jnp.asarray(self.loading.target_weight), self.scale)
        basis, params = basis_field(read(self.files["constrained"]))
        modes = mode_gradients(1.0 + (self.stretch - 1.0) * MODE_SIZES).reshape(-1, 2, 2)
        modes = jnp.asarray(np.moveaxis(modes, 0, -1)[..., None], jnp.float32)
        cells = self.F.shape[-1]
        F = jnp.concatenate([self.F, jnp.broadcast_to(modes, (*modes.shape[:3], cells))], axis=2)
        P = jax.jit(mean_of_subcells(basis.stress))(F, jnp.asarray(params, jnp.float32))
        sizes = jnp.sqrt(jnp.mean(jnp.sum(P[:, :, len(self.scale) :] ** 2, axis=(0, 1)), axis=-1))
        scale = jnp.concatenate([self.scale, sizes])
        return Target(F, P / scale[:, None], jnp.ones((2, 2, 1, 1)), scale)

    def gaps(self):
        """(steps, :class:`EquilibriumGap`) of each test."""
        loading = self.loading
        return [
            (
                np.flatnonzero(loading.load_case == k),
                EquilibriumGap.build(self.mesh, loading.constrained[k], loading.known[k], self.variance),
            )
            for k in range(loading.load_case.max() + 1)
        ]

    def save(self, output, network, history, title, attributes) -> None:
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
                "node": json.dumps(self.spec),
                "hypernetwork": self.hypernetwork,
                "length_scale": self.length,
            },
            parents=list(self.files.values()),
        )
