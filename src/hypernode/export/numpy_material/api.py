"""Stress, tangent and energy of a material whose law is written for complex numbers."""

import json
import warnings
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from hypernode.material.domain import Domain

#: Imaginary step of a derivative: so small that its square is nothing beside one, there is no rounding by a difference.
STEP = 1e-30


class Law(NamedTuple):
    """parameters(data, spec, X), stress(F[i, J, n], parameters) and energy(F[i, J, n], parameters)."""

    parameters: Callable
    stress: Callable
    energy: Callable


class Material:
    """A heterogeneous hyperelastic sheet in plane stress.

    Attributes:
        units: what stress, energy (per reference volume) and length mean.
        seen: the deformations that the test has seen, beyond which the material warns once; None where nobody knows.
    """

    def __init__(self, data, law):
        """Args: data: the arrays of the .npz file; law: how they are used."""
        self._data = {name: np.asarray(data[name]) for name in data}
        self._data = {k: v.astype(float) if v.dtype == np.float32 else v for k, v in self._data.items()}
        self._spec, self._law, self._warned = json.loads(str(self._data["spec"])), law, False
        self.units = self._spec["units"]
        self.seen = Domain(self._spec["seen"]) if self._spec["seen"] else None

    def energy(self, X, F):
        """Energy density Psi [..., n], zero at F = 1.

        Args:
            X: positions (n, 2), in the length unit.
            F: in-plane deformation gradients (..., n, 2, 2), of one or more states of all positions.
        """
        return self._evaluate(self._law.energy, X, F)

    def stress(self, X, F):
        """First Piola-Kirchhoff stress P [..., n, i, J]; arguments as in :meth:`energy`."""
        return self._evaluate(self._law.stress, X, F)

    def tangent(self, X, F):
        """dP_iJ/dF_kL as [..., n, i, J, k, L]; arguments as in :meth:`energy`."""
        return self._evaluate(self._tangent, X, F)

    def _tangent(self, F, params):
        """[i, J, k, L, n]: P at F + i STEP has the derivative in its imaginary part (Squire and Trapp 1998)."""
        found = np.empty((2, 2, *F.shape))
        for k in range(2):
            for L in range(2):
                moved = F.astype(complex)
                moved[k, L] += 1j * STEP
                found[:, :, k, L] = np.imag(self._law.stress(moved, params)) / STEP
        return found

    def _evaluate(self, function, X, F):
        X, F = np.asarray(X, float), np.asarray(F, float)
        if X.ndim != 2 or X.shape[1] != 2 or F.shape[-3:] != (len(X), 2, 2):
            raise ValueError(f"X must be (n, 2) and F (..., n, 2, 2), not {X.shape} and {F.shape}")
        remark = "" if self._warned or self.seen is None else self.seen.remark(F)
        if remark:
            self._warned = True
            warnings.warn(remark, UserWarning, stacklevel=3)
        params = self._law.parameters(self._data, self._spec, X)
        states = np.moveaxis(F.reshape(-1, *F.shape[-3:]), 1, -1)
        found = np.stack([np.moveaxis(function(state, params), -1, 0) for state in states])
        return found.reshape(*F.shape[:-2], *found.shape[2:])
