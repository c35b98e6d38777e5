"""A picture compared with the first on a mesh: the displacement of its nodes.

It goes from blurred pictures and a stiff mesh to sharp ones and a free mesh. A displacement of several pixels is found
where a blur of its size leaves something to follow, and what is held together moves together.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse
from jaxtyping import Float, UInt
from scipy.ndimage import gaussian_filter

from hypernode.data.information import assembled
from hypernode.fem.factors import factorise
from hypernode.fem.mesh import Mesh
from hypernode.pictures.elements import Elements, Linearised
from hypernode.pictures.spline import Spline

#: Standard deviation of the blur of each level [pixel], and the length below which the mesh is held together, over it.
BLURS = (8.0, 4.0, 2.0, 1.0)
_HELD = 16.0
#: Steps of a level, and the root mean square change of the nodes at which the last one has converged [pixel].
STEPS = 30
CONVERGED = 1e-3
#: The same of a level on the way, over its blur.
_SETTLED = 0.01


@dataclass(frozen=True)
class Followed:
    """One picture compared with the first.

    Attributes:
        u: displacement of the nodes [pixel].
        linear: what the picture says near it, per squared grey level of noise.
        noise: standard deviation of each pixel of both pictures, were all that is left of their difference noise.
        converged: whether the last step moved the nodes less than :data:`CONVERGED`.
    """

    u: Float[np.ndarray, "node 2"]
    linear: Linearised
    noise: float
    converged: bool


class Follower:
    """The first picture on a mesh, at every level of blur.

    Args:
        reference: the first picture.
        mesh: of :func:`hypernode.pictures.elements.lattice`.
        blurred: whether a displacement of more than a pixel is to be found.
        held: share of the mean information by which nodes are held together when pictures are sharp.
    """

    def __init__(self, reference: UInt[np.ndarray, "row column"], mesh: Mesh, blurred: bool, held: float):
        blurs = (*BLURS, 0.0) if blurred else (0.0,)
        self._levels = [(blur, Elements.of(mesh, _blurred(reference, blur))) for blur in blurs]
        self._bent, self._held = bending(mesh), held

    @property
    def elements(self) -> Elements:
        """Of the picture as it is."""
        return self._levels[-1][1]

    def likeliest(self, picture: UInt[np.ndarray, "row column"], starts):
        """Of some displacements the one with which pictures are most alike, once they are blurred."""
        blur, elements = self._levels[0]
        spline = Spline.of(_blurred(picture, blur))

        def unlike(u):
            linear = elements.linearise(spline, u)
            return np.mean(linear.residual[linear.seen] ** 2) if linear.seen.any() else np.inf

        return min(starts, key=unlike)

    def follow(self, picture: UInt[np.ndarray, "row column"], start: Float[np.ndarray, "node 2"]) -> Followed:
        """The displacement since the first picture, from ``start`` on."""
        u, change = start, np.inf
        for blur, elements in self._levels:
            spline = Spline.of(_blurred(picture, blur))
            enough = _SETTLED * blur if blur else CONVERGED
            for _ in range(STEPS):
                linear = elements.linearise(spline, u)
                # Without texture, noise would lead nodes astray; a blurred picture has next to none.
                told = elements.told(linear, 0.0 if blur else self._noise(linear))
                K, b = assembled(elements.mesh.dofs, *told, u.size)
                held = K.diagonal().mean() * max((_HELD * blur / elements.side) ** 4, self._held) * self._bent
                du = factorise((K + held).tocsc()).solve(b - held @ u.ravel()).reshape(-1, 2)
                u, change = u + du, float(np.sqrt(np.mean(du**2)))
                if not change > enough:
                    break
        linear = elements.linearise(spline, u)
        return Followed(u, linear, self._noise(linear), change <= CONVERGED)

    def _noise(self, linear: Linearised) -> float:
        """Standard deviation of each pixel of both pictures, were all that is left of their difference noise."""
        freedom = linear.seen.sum() * self.elements.side**2 - self.elements.mesh.nodes.size
        return float(np.sqrt((linear.residual**2).sum() / max(freedom, 1) / linear.noise_share))


def bending(mesh: Mesh) -> scipy.sparse.csr_matrix:
    """Sum of squared second differences of nodal values along both lines through each node (dof, dof)."""
    numbers, rows = mesh.node_numbers, []
    for grid in (numbers, numbers.T):
        middle = np.stack([grid[:-2], grid[1:-1], grid[2:]], axis=-1).reshape(-1, 3)
        rows.append(middle[(middle >= 0).all(axis=1)])
    three = np.concatenate(rows)
    entries = np.tile([1.0, -2.0, 1.0], len(three)), (np.repeat(np.arange(len(three)), 3), three.ravel())
    second = scipy.sparse.csr_matrix(entries, (len(three), len(mesh.nodes)))
    return scipy.sparse.kron(second.T @ second, scipy.sparse.identity(2), format="csr")


def _blurred(picture, blur: float):
    return gaussian_filter(picture.astype(float), blur) if blur else picture.astype(float)
