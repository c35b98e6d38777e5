"""What several stages read from a data file in the same way."""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.mechanics.mesh import Mesh


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
        resultant: force over thickness on the positive edge of each component (step, 2), 0 where
            not measured.
        measured: whether that resultant is measured (step, 2).
        P_average: force over cross-section, ``pre-training1`` (step, 2, 2), 0 where not measured.
        scale: norm of P_average (step,), the stress unit of each step.
        constrained, known: per test and edge and component (test, edge, 2).
    """

    test: np.ndarray
    t: np.ndarray
    resultant: np.ndarray
    measured: np.ndarray
    P_average: np.ndarray
    scale: np.ndarray
    constrained: np.ndarray
    known: np.ndarray

    @property
    def target_weight(self) -> Float[np.ndarray, "2 2 step 1"]:
        """1 where P_average is known [i, J, step, 1]: measured normal stresses, and shear (zero)."""
        weight = np.ones((2, 2, len(self.t), 1))
        for i in range(2):
            weight[i, i, :, 0] = self.measured[:, i] | ~self.constrained[self.test].any(axis=(1, 2))
        return weight

    @classmethod
    def of(cls, measurement: xr.Dataset) -> "Loading":
        """Read the loading of a measurement file.

        A component counts as measured where one of its two opposite edges carries a known force;
        the two are balanced, so their mean is used where both are known. A component in which both
        edges are free has a known resultant of zero.
        """
        lower, upper = measurement["corners"].values
        force = stress_resultants(measurement)
        constrained = measurement["edge_constrained"].values > 0
        test = measurement["test"].values
        # Pairs of opposite edges in the order left, right, bottom, top: axis 0 then axis 1.
        outward = np.stack([[-force[:, 0, 0], force[:, 1, 0]], [-force[:, 2, 1], force[:, 3, 1]]])
        counts = np.isfinite(outward).sum(axis=1)
        total = np.nansum(outward, axis=1) / np.maximum(counts, 1)
        section = (upper - lower)[::-1]
        P = np.zeros((len(test), 2, 2))
        P[:, 0, 0], P[:, 1, 1] = total[0] / section[0], total[1] / section[1]
        scale = np.linalg.norm(P.reshape(len(test), 4), axis=1)
        if (scale <= 0).any():
            raise ValueError(
                f"load step {int(np.argmin(scale))} carries no force: every step needs a measured resultant"
            )
        H = np.abs(measurement["H"].values).reshape(len(test), 4).max(axis=1)
        largest = np.array([H[test == k].max() for k in test])
        first = [int(np.flatnonzero(test == k)[0]) for k in range(test.max() + 1)]
        known = np.isfinite(force) & constrained
        return cls(test, H / largest, total.T, (counts > 0).T, P, scale, constrained[first], known[first])
