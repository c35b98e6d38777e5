"""A factor of the stiffness in every cell, on top of a field of materials: what that field leaves unexplained."""

import numpy as np
import scipy.linalg
import scipy.sparse

from hypernode.fem.factors import factorise
from hypernode.identification.interface_fit import InterfaceFit
from hypernode.identification.regulariser import CORNER_SHARE, SIDE_SHARE


def pairs_of(mesh):
    sides, length, _ = mesh.neighbours()
    corners, across = mesh.diagonal_neighbours()
    unit = np.sqrt(mesh.areas.mean())
    pairs = np.concatenate([sides, corners])
    n = len(pairs)
    D = scipy.sparse.csr_matrix((np.repeat([1.0, -1.0], n), (np.tile(np.arange(n), 2), pairs.T.ravel())), (n, len(mesh.cells)))
    return D, np.concatenate([SIDE_SHARE * length, CORNER_SHARE * across]) / unit


class StiffnessFit:
    def __init__(self, fit: InterfaceFit, field, base, weight=25.0, smallest=0.02, scale=None, groups=None):
        self.fit, self.field, self.base = fit, field, base
        self.D, self.length = pairs_of(fit.sheet.mesh)
        self.weight, self.smallest, self.scale = weight, smallest, scale
        count = len(fit.sheet.mesh.cells)
        groups = np.arange(count) if groups is None else groups
        self.G = scipy.sparse.csr_matrix((np.ones(count), (np.arange(count), groups)))
        self.of, _ = field.cells()

    def jacobians(self, sheet, states, sigma):
        fit, found = self.fit, []
        dofs = sheet.mesh.dofs
        for (u, _, K), boundary, observe, forces in zip(states, fit.boundaries, fit.observe, fit.forces, strict=True):
            f = sheet.cell_forces(u, self.of)
            B = scipy.sparse.csr_matrix((f.ravel(), (dofs.ravel(), np.repeat(np.arange(len(f)), 8))), (sheet.mesh.nodes.size, len(f))) @ self.G
            free = boundary.free
            du = -factorise(K[free][:, free]).solve(B[free].toarray())
            J = np.empty((observe.shape[0] + len(forces), B.shape[1]))
            J[: observe.shape[0]] = (observe[:, free] / sigma) @ du
            for row, f in zip(J[observe.shape[0] :], forces, strict=True):
                row[:] = (B.T @ f.direction + (K @ f.direction)[free] @ du) / f.sigma
            found.append(J)
        return found

    def _weights(self, values):
        size = np.sqrt((self.D @ values) ** 2 + self.smallest**2)
        return self.weight * self.length / size / (1.0 if self.scale is None else 1.0 + size / self.scale), size

    def prior(self, values):
        _, size = self._weights(values)
        return self.weight * float(self.length @ (size if self.scale is None else self.scale * np.log1p(size / self.scale)))

    def descend(self, delta, states, iterations=10, rounds=3, convex=4, jump_scale=0.05, tolerance=1e-3, say=None):
        """delta: logarithm of the factor (cell,); base: level of the field by cell, for jumps."""
        fit = self.fit
        whole = fit.sheet
        sigma, count = np.inf, sum(o.shape[0] for o in fit.observe)
        sheet = whole.stiffer(np.exp(delta))
        try:
            fit.sheet = sheet
            states = fit.states(self.field, states)
            if states is None:
                return None
            for number in range(iterations):
                self.scale = None if number < convex else jump_scale
                raw = fit.residuals(states, 1.0)
                left = np.sqrt(sum(float(r[: o.shape[0]] @ r[: o.shape[0]]) for r, o in zip(raw, fit.observe)) / count)
                sigma = max(fit.sigma, min(left, sigma))
                shared = fit.shared(states, sigma, anew=number % 3 == 0)
                residuals = fit.residuals(states, sigma)
                H, g = shared.normal(self.jacobians(sheet, states, sigma), residuals)
                before = 0.5 * shared.squared(residuals) + self.prior(self.base + delta)
                step = np.zeros(self.G.shape[1])
                for _ in range(rounds):
                    w, _ = self._weights(self.base + delta + self.G @ step)
                    R = (self.D.T @ scipy.sparse.diags(w) @ self.D).tocsr()
                    A = H + (self.G.T @ R @ self.G).toarray()
                    A[np.diag_indices_from(A)] += 1e-3 * np.diag(H).mean() + 1e-9
                    step = -scipy.linalg.solve(A, g + self.G.T @ (R @ (self.base + delta)), assume_a="pos")
                change = self.G @ step
                moved = None
                for fraction in (1.0, 0.5, 0.2, 0.05):
                    trial = delta + fraction * np.clip(change, -1.0, 1.0)
                    fit.sheet = whole.stiffer(np.exp(trial))
                    reached = fit.states(self.field, [s[0] for s in states])
                    if reached is not None:
                        after = 0.5 * shared.squared(fit.residuals(reached, sigma)) + self.prior(self.base + trial)
                        if after < before:
                            moved = trial, reached, before - after
                            break
                if say:
                    say(number, before, left / fit.sigma, moved and (fraction, moved[2]))
                if moved is None:
                    break
                delta, states, gained = moved
                sheet = fit.sheet
                if gained < tolerance * before and number > convex:
                    break
        finally:
            fit.sheet = whole
        return delta, states
