"""What the three stages that train the hyper-network share: data on the grid, the network, its target."""

import dataclasses
import functools
import json
from collections.abc import Mapping

import jax
import jax.numpy as jnp
import numpy as np
import xarray as xr

from hypernode.config.methods import Frequencies, Method
from hypernode.data.loading import Loading
from hypernode.data.measurement import field_gradient, mesh_of, nodal_forces
from hypernode.fem.equilibrium_gap import EquilibriumGap
from hypernode.fem.mesh import Mesh
from hypernode.material.basis_file import basis_field
from hypernode.material.laws import mean_of_subcells
from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.modes import mode_gradients
from hypernode.networks.fourier_mlp import FourierMLP
from hypernode.networks.weights import from_arrays, make_network, split_trainable
from hypernode.training.targets import Target

#: Sizes of the homogeneous modes that pre-training learns, as shares of the largest stretch of the test.
MODE_SIZES = np.array([0.08, 0.5, 1.0])
#: Factor on the random kernel of a new network's last layer: small, so that the start is nearly homogeneous,
#: and not zero, so that gradients reach the layers below.
LAST_KERNEL = 0.01
#: Largest standard deviation of a hyper-network's frequencies over the number of cells along the longest side: with
#: twice as much, a network of 18 x 18 cells is right at their centres and wrong by a half between them.
LARGEST_FREQUENCY = 0.175
#: Between the seeds of a network and of those that are tried in its place.
SEEDS_APART = 1000


@dataclasses.dataclass(frozen=True)
class InverseProblem:
    """The measured grid with the deformation on it, and a hyper-network to be trained.

    Attributes:
        name: case, for progress and messages.
        method: architecture, optimisers and weights.
        inputs: opened files of the earlier stages, without any truth: ``measurement``, ``field`` (interpolant or
            gradient), ``homogenised``, and where there are such ``constrained`` and ``previous``, the hyper-network to
            go on from.
    """

    name: str
    method: Method
    inputs: Mapping[str, xr.Dataset]

    @functools.cached_property
    def mesh(self) -> Mesh:
        """The measured grid."""
        return mesh_of(self.inputs["measurement"])

    @functools.cached_property
    def loading(self) -> Loading:
        """What is known about the loading of every step."""
        return Loading.of(self.inputs["measurement"])

    @property
    def length(self) -> float:
        """Longest side of the sheet: the unit of the networks' positions."""
        return float(self.mesh.size.max())

    @functools.cached_property
    def X(self) -> jax.Array:
        """Cell centres scaled to the longest side (cell, 2)."""
        return jnp.asarray((self.mesh.centres - self.mesh.lower) / self.length, jnp.float32)

    @functools.cached_property
    def F(self) -> jax.Array:
        """Deformation gradient at the centres [i, J, step, cell]."""
        return jnp.asarray(field_gradient(self.inputs["field"]), jnp.float32)

    @property
    def variance(self) -> np.ndarray:
        """How uncertain F is in a cell, over the mean (cell,)."""
        return self.inputs["field"]["gradient_variance"].values

    @functools.cached_property
    def spec(self) -> dict:
        """Fields of the neural-ODE material."""
        stored = json.loads(self.inputs["homogenised"].attrs["node"])
        return {k: tuple(v) if isinstance(v, list) else v for k, v in stored.items()}

    @functools.cached_property
    def centre(self) -> jax.Array:
        """Homogenised parameters, about which the prior is centred."""
        return jnp.asarray(self.inputs["homogenised"]["node_params"].values, jnp.float32)

    @functools.cached_property
    def hypernetwork(self) -> str:
        """Architecture of the hyper-network, as a file holds it.

        Its frequencies are no larger than the cells are small: it is trained at their centres, and what is finer than
        the distance between these would be free.
        """
        settings = self.method.hypernetwork
        cells = float(self.length / np.sqrt(self.mesh.areas.mean()))
        scale = min(settings.frequency_scale, LARGEST_FREQUENCY * cells)
        settings = settings.model_copy(update={"frequency_scale": scale})
        return settings.model_dump_json(include=set(Frequencies.model_fields))

    @functools.cached_property
    def node(self) -> NodeMaterial:
        """The material at a point, as training uses it."""
        return NodeMaterial(**self.spec).with_units_as_data()

    @property
    def scale(self):
        """Stress unit of each step (step,), one where the method does not normalise."""
        return jnp.asarray(self._scale, jnp.float32)

    @property
    def _scale(self):
        return self.loading.scale if self.method.normalised else np.ones_like(self.loading.scale)

    @property
    def nodal_force(self) -> np.ndarray | None:
        """Outward force on each node of the outline over the thickness (step, node, 2), or None where none is known."""
        return nodal_forces(self.inputs["measurement"])

    @property
    def _architecture(self):
        """(settings, inputs beside the position, outputs) of the hyper-network."""
        return Frequencies.model_validate_json(self.hypernetwork), 0, self.node.size

    def new_network(self, number: int = 0) -> FourierMLP:
        """A hyper-network with random weights, others for each number.

        With ``from_bias`` it gives nearly the homogenised parameters.
        """
        network = make_network(*self._architecture, self.method.seed + 1 + SEEDS_APART * number)
        if self.method.initialisation.from_bias:
            last = network.layers[-1]
            last.bias[...] = self.centre
            last.kernel[...] = LAST_KERNEL * last.kernel[...]
        return network

    def trainable(self):
        """(params, params -> network) of what an earlier stage left, ``previous``, or else of a new one."""
        if "previous" in self.inputs:
            return split_trainable(from_arrays(*self._architecture, self.inputs["previous"], "hypernetwork"))
        return self.other_trainable(0)

    def other_trainable(self, number: int):
        """(params, params -> network) of a new one; each number has random weights of its own."""
        return split_trainable(self.new_network(number))

    @functools.cached_property
    def materials(self) -> np.ndarray:
        """Number of the material of each cell (cell,): cells of one number have the same in the constrained field."""
        _, params = basis_field(self.inputs["constrained"])
        return np.unique(params.reshape(-1, params.shape[-1]), axis=1, return_inverse=True)[1].ravel()

    @property
    def has_field(self) -> bool:
        """Whether there is a constrained field to learn."""
        return "constrained" in self.inputs

    def target(self) -> Target:
        """What pre-training aims at: force over cross-section, or the stress of the constrained field.

        The constrained field also says what cells would do under deformations that they have not seen. Homogeneous
        modes of the size of the test and of shares of it keep the networks from inventing an answer there. The smallest
        one fixes the stiffness of the undeformed sheet, where coarse steps of a neural ODE may leave a spike that stops
        Newton's method.
        """
        scale = self._scale[:, None]
        if not self.has_field:
            P = np.moveaxis(self.loading.P_average, 0, -1)[..., None] / scale
            P = np.broadcast_to(P, self.F.shape)
            return Target(self.F, jnp.asarray(P, jnp.float32), jnp.asarray(self.loading.target_weight), self.scale)
        basis, params = basis_field(self.inputs["constrained"])
        largest = float(self.inputs["measurement"]["stretch"].values.max())
        modes = mode_gradients(1.0 + (largest - 1.0) * MODE_SIZES).reshape(-1, 2, 2)
        modes = jnp.asarray(np.moveaxis(modes, 0, -1)[..., None], jnp.float32)
        cells = self.F.shape[-1]
        F = jnp.concatenate([self.F, jnp.broadcast_to(modes, (*modes.shape[:3], cells))], axis=2)
        P = jax.jit(mean_of_subcells(basis.stress))(F, jnp.asarray(params, jnp.float32))
        sizes = jnp.sqrt(jnp.mean(jnp.sum(P[:, :, len(self.scale) :] ** 2, axis=(0, 1)), axis=-1))
        scale = jnp.concatenate([self.scale, sizes])
        return Target(F, P / scale[:, None], jnp.ones((2, 2, 1, 1)), scale)

    def gaps(self):
        """(steps, :class:`EquilibriumGap`) of each load case."""
        loading = self.loading
        return [
            (
                np.flatnonzero(loading.load_case == k),
                EquilibriumGap.build(self.mesh, loading.constrained[k], loading.known[k], self.variance),
            )
            for k in range(loading.load_case.max() + 1)
        ]
