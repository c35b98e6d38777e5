"""What is known about the forces of every load step, as mean stresses."""

import dataclasses
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Int

from hypernode.data.measurement import stress_resultants
from hypernode.fem.mesh import EDGE_NAMES, EDGES, tied_edge
from hypernode.mechanics.loads import CONSTRAINED


@dataclass(frozen=True, kw_only=True)
class Loading:
    """What is known about the loading of every step, in stresses rather than forces.

    Attributes:
        load_case: load case of each step (step,).
        t: load parameter of each step, its largest displacement gradient over that of its load case.
        resultant: force over thickness on the edge that is tied for each component, :func:`tied_edge` (step, 2),
            0 where none is.
        P_average: force over cross-section, ``pre-training1``, component i on the sides normal to J (step, 2, 2), 0
            where not measured.
        measured: whether that mean stress is known (step, 2, 2).
        scale: norm of P_average (step,), the stress unit of each step; of one whose force is not known, that of the
            largest known one in proportion to their displacement gradients.
        constrained, known: per load case and edge and component (case, edge, 2).
    """

    load_case: np.ndarray
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
        free = ~self.constrained[self.load_case].any(axis=(1, 2))
        for i in range(2):
            weight[i, i] = np.maximum(weight[i, i], free)
            weight[i, 1 - i] = np.maximum(weight[i, 1 - i], ~self.measured[:, 1 - i, i])
        return weight[..., None]

    def of_steps(self, steps: Int[np.ndarray, " kept"]) -> "Loading":
        """That of some of the steps; load cases keep their numbers and load parameters."""
        by_step = ("load_case", "t", "resultant", "P_average", "measured", "scale")
        return dataclasses.replace(self, **{name: getattr(self, name)[steps] for name in by_step})

    @classmethod
    def of(cls, measurement: xr.Dataset) -> "Loading":
        """Read the loading of a measurement file.

        The mean of P_iJ is the sum of traction i times X_J over the outline. It follows from resultants where the only
        edges that hold component i are normal to J, and one of the two carries a known force. Both forces balance, so
        their mean is used where both are known. Where no edge holds component i and all are known to be free, the mean
        of P_ii is zero.
        """
        lower, upper = measurement["corners"].values
        force = stress_resultants(measurement)
        constrained = measurement["edge_constrained"].values > 0
        load_case = measurement["load_case"].values
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
        H = np.abs(measurement["H"].values).reshape(len(load_case), 4).max(axis=1)
        scale = _scale(np.linalg.norm(P.reshape(len(load_case), 4), axis=1), measured.any(axis=(1, 2)), H)
        largest = np.array([H[load_case == k].max() for k in load_case])
        first = [int(np.flatnonzero(load_case == k)[0]) for k in range(load_case.max() + 1)]
        known = np.isfinite(force) & constrained
        resultant = np.zeros((len(load_case), 2))
        for step, k in enumerate(first[number] for number in load_case):
            for i in range(2):
                tied = tied_edge(constrained[k], known[k], i)
                if tied is not None:
                    axis, sign = EDGES[tied]
                    resultant[step, i] = sign * total[step, axis, i]
        return cls(
            load_case=load_case,
            t=H / largest,
            resultant=resultant,
            P_average=P,
            measured=measured,
            scale=scale,
            constrained=constrained[first],
            known=known[first],
        )


def _scale(
    size: Float[np.ndarray, " step"], known: Bool[np.ndarray, " step"], H: Float[np.ndarray, " step"]
) -> Float[np.ndarray, " step"]:
    """The stress unit of each step, from the sizes of those mean stresses that are known."""
    if (size[known] <= 0.0).any() or not known.any():
        step = int(np.flatnonzero(known)[np.argmin(size[known])]) if known.any() else 0
        raise ValueError(f"load step {step} carries no force: a sheet needs a measured resultant")
    largest = int(np.argmax(size))
    return np.where(known, size, size[largest] * H / H[largest])


def load_kind(constrained: Bool[np.ndarray, "edge 2"], H: Float[np.ndarray, "step 2 2"]) -> str:
    """The kind of load of a test, from the components of edges that are held and from how they move.

    Of kinds that hold the same it is the one that says least: of a whole outline that is held, ``general``.
    """
    held = {(EDGE_NAMES[edge], component) for edge, component in np.argwhere(constrained).tolist()}
    kinds = [kind for kind, pairs in CONSTRAINED.items() if set(pairs) == held]
    if "shear" in kinds:
        return "shear" if np.abs(H[:, 0, 1]).max() > np.abs(H[:, 1, 1]).max() else "clamped_y"
    return kinds[-1] if kinds else "general"
