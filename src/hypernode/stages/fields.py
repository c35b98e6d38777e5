"""What several stages read from a data file in the same way."""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.mechanics.mesh import EDGES, Mesh, tied_edge


def mesh_of(dataset: xr.Dataset) -> Mesh:
    """The mesh that a file describes."""
    lower, upper = dataset["corners"].values
    return Mesh(dataset["X"].values, dataset["cells"].values, lower, upper)


def deformation_gradient(mesh: Mesh, u: Float[np.ndarray, "... node 2"]) -> Float[np.ndarray, "... cell 2 2"]:
    """F at the cell centres from nodal displacements, by bilinear shape functions."""
    return np.einsum("...cai,caJ->...ciJ", u[..., mesh.cells, :], mesh.gradient_operator()) + np.eye(2)


def field_gradient(dataset: xr.Dataset) -> Float[np.ndarray, "2 2 step cell"]:
    """F[i, J, step, cell] at the cell centres, of an interpolant file or of a gradient file."""
    name = "F_interpolated" if "F_interpolated" in dataset else "F"
    return np.moveaxis(dataset[name].values, (2, 3), (0, 1))


def mean_gradient(mesh: Mesh, F: Float[np.ndarray, "2 2 step cell"]) -> Float[np.ndarray, "2 2 step 1"]:
    """Mean of F over the sheet."""
    return np.sum(F * (mesh.areas / mesh.areas.sum()), axis=-1, keepdims=True)


def displacement_noise(measurement: xr.Dataset) -> float:
    """Standard deviation of the mean over the repeats of the measured displacement."""
    return float(measurement.attrs["displacement_noise"]) / np.sqrt(measurement.sizes["repeat"])


def relaxation(measurement: xr.Dataset) -> Float[np.ndarray, "step 1 1"]:
    """Recorded over elastic force of each step, for the components of every edge."""
    return measurement["relaxation"].values[:, None, None]


def stress_resultants(measurement: xr.Dataset) -> Float[np.ndarray, "step edge 2"]:
    """Measured force over thickness of an elastic sheet, NaN where not measured."""
    return measurement["edge_force"].values / relaxation(measurement) / float(measurement.attrs["thickness"])


@dataclass(frozen=True)
class Loading:
    """What is known about the loading of every step, in stresses rather than forces.

    Attributes:
        test: load case of each step (step,).
        t: load parameter of each step, its largest displacement gradient over that of its test.
        resultant: force over thickness on the edge that is tied for each component, :func:`tied_edge` (step, 2),
            0 where none is.
        P_average: force over cross-section, ``pre-training1``, component i on the sides normal to J (step, 2, 2), 0
            where not measured.
        measured: whether that mean stress is known (step, 2, 2).
        scale: norm of P_average (step,), the stress unit of each step.
        constrained, known: per test and edge and component (test, edge, 2).
    """

    test: np.ndarray
    t: np.ndarray
    resultant: np.ndarray
    P_average: np.ndarray
    measured: np.ndarray
    scale: np.ndarray
    constrained: np.ndarray
    known: np.ndarray

    @property
    def target_weight(self) -> Float[np.ndarray, "2 2 step 1"]:
        """1 where P_average is a target [i, J, step, 1]: where it is known, and shear that nothing applies (zero)."""
        weight = np.moveaxis(self.measured, 0, -1).astype(float)
        free = ~self.constrained[self.test].any(axis=(1, 2))
        for i in range(2):
            weight[i, i] = np.maximum(weight[i, i], free)
            weight[i, 1 - i] = np.maximum(weight[i, 1 - i], ~self.measured[:, 1 - i, i])
        return weight[..., None]

    @classmethod
    def of(cls, measurement: xr.Dataset) -> "Loading":
        """Read the loading of a measurement file.

        The mean of P_iJ is the sum of traction i times X_J over the outline. It follows from resultants where the only
        edges that hold component i are normal to J and one of the two carries a known force; the two are balanced, so
        that their mean is used where both are known. Without any edge that holds it, the mean of P_ii is zero where
        all are known to be free.
        """
        lower, upper = measurement["corners"].values
        force = stress_resultants(measurement)
        constrained = measurement["edge_constrained"].values > 0
        test = measurement["test"].values
        section = (upper - lower)[::-1]
        # Pairs of opposite edges in the order left, right, bottom, top: axis 0 then axis 1.
        outward = np.stack([-force[:, 0::2], force[:, 1::2]])
        seen = np.isfinite(outward)
        total = np.nansum(outward, axis=0) / np.maximum(seen.sum(axis=0), 1)
        held = (constrained[:, 0::2] | constrained[:, 1::2]).transpose(0, 2, 1)
        finite = seen.any(axis=0).transpose(0, 2, 1)
        free = ~held.any(axis=2, keepdims=True) & np.eye(2, dtype=bool)
        measured = finite & (held & ~held[..., ::-1] | held & np.eye(2, dtype=bool) | free)
        P = np.where(measured, total.transpose(0, 2, 1) / section, 0.0)
        scale = np.linalg.norm(P.reshape(len(test), 4), axis=1)
        if (scale <= 0).any():
            raise ValueError(
                f"load step {int(np.argmin(scale))} carries no force: every step needs a measured resultant"
            )
        H = np.abs(measurement["H"].values).reshape(len(test), 4).max(axis=1)
        largest = np.array([H[test == k].max() for k in test])
        first = [int(np.flatnonzero(test == k)[0]) for k in range(test.max() + 1)]
        known = np.isfinite(force) & constrained
        resultant = np.zeros((len(test), 2))
        for step, k in enumerate(first[number] for number in test):
            for i in range(2):
                tied = tied_edge(constrained[k], known[k], i)
                if tied is not None:
                    axis, sign = EDGES[tied]
                    resultant[step, i] = sign * total[step, axis, i]
        return cls(test, H / largest, resultant, P, measured, scale, constrained[first], known[first])
