"""What the identified material of a phase does in the deformations that it has seen, and how sure that is."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float, Int

from hypernode.export.fitting import components
from hypernode.export.run import Run
from hypernode.material.domain import Domain
from hypernode.mechanics.modes import MODES, mode_gradients

#: Relative uncertainty of a stress in any case: what a testing machine of class 1 (ISO 7500-1) leaves.
SURE = 0.01
#: Amplitudes at which it is asked whether a homogeneous deformation has been seen.
AMPLITUDES = 64
#: Share of the test's largest stretch below which a deformation that has been seen says nothing of a law's shape.
SMALL = 0.1


@dataclass(frozen=True, kw_only=True)
class Curves:
    """The stresses of a phase in some deformations.

    Attributes:
        phase: its number, from the softest.
        cells: of the phase.
        share: of the area of the sheet.
        modes: name of the deformation of every point.
        F: deformation gradients.
        by_cell: stress of every cell there, three numbers a point as of
            :func:`~hypernode.export.fitting.components`.
        deviations: of the phase's median in every posterior sample; none without samples.
    """

    phase: int
    cells: Int[np.ndarray, " cell"]
    share: float
    modes: tuple[str, ...]
    F: Float[np.ndarray, "point 2 2"]
    by_cell: Float[np.ndarray, "cell point 3"]
    deviations: Float[np.ndarray, "sample point 3"]

    @cached_property
    def stress(self) -> Float[np.ndarray, "point 3"]:
        """Median over the cells: those that a contour cuts do not count."""
        return np.median(self.by_cell, axis=0)

    @cached_property
    def noise(self) -> Float[np.ndarray, "point 3"]:
        """Standard deviation of the stress: the spread of the posterior samples, and what is uncertain in any case."""
        spread = self.deviations.std(axis=0, ddof=1) if len(self.deviations) > 1 else np.zeros_like(self.stress)
        return np.sqrt(spread**2 + (SURE * np.linalg.norm(self.stress, axis=1, keepdims=True)) ** 2)

    @cached_property
    def stiffness(self) -> float:
        """Shear modulus of the neo-Hookean sheet that explains the stress best."""
        F = self.F
        J = np.linalg.det(F)[:, None, None]
        # P of mu = 1: F - J^-3 cof F.
        cofactor = np.stack([np.stack([F[:, 1, 1], -F[:, 1, 0]], -1), np.stack([-F[:, 0, 1], F[:, 0, 0]], -1)], 1)
        unit = components(F - cofactor / J**3)
        weight = 1.0 / self.noise**2
        return float(np.sum(weight * unit * self.stress) / np.sum(weight * unit**2))

    @property
    def largest_stretch(self) -> float:
        """Largest principal stretch of the points."""
        return float(np.linalg.svd(self.F, compute_uv=False).max())


def stacked(curves: list[Curves]):
    """(F, stress, noise, stiffness) of phases with as many points for each, of which the last may not count."""
    points = max(len(each.F) for each in curves)
    F, stress = np.tile(np.eye(2), (len(curves), points, 1, 1)), np.zeros((len(curves), points, 3))
    noise = np.full_like(stress, np.inf)
    for k, each in enumerate(curves):
        own = slice(len(each.F))
        F[k, own], stress[k, own], noise[k, own] = each.F, each.stress, each.noise
    return F, stress, noise, np.array([each.stiffness for each in curves])


def curves_of(run: Run) -> list[Curves]:
    """Those of every phase, from the softest.

    The deformations are the mean one of the phase in every step of the test, and the homogeneous modes. Modes go as far
    as the cells of the phase have seen. They have as many amplitudes as a load case has steps, since the test has
    measured as many numbers.
    """
    phases, area = run.phase, run.mesh.areas
    return [_curves(run, phase, np.flatnonzero(phases == phase), area) for phase in np.unique(phases)]


def _curves(run: Run, phase: int, cells, area) -> Curves:
    share = area[cells] / area[cells].sum()
    own = np.einsum("c,scij->sij", share, run.F[:, cells])
    modes, F = ["test"] * len(own), [own]
    steps = len(own) // len(np.unique(run.files["measurement"]["load_case"].values))
    for mode, along in _seen_modes(Domain.of(run.F[:, cells], directional=True), steps):
        modes += [mode] * len(along)
        F.append(along)
    F = np.concatenate(F)
    by_cell = _stress(run.material, run.mesh.centres[cells], F)
    return Curves(
        phase=int(phase),
        cells=cells,
        share=float(area[cells].sum() / area.sum()),
        modes=tuple(modes),
        F=F,
        by_cell=by_cell,
        deviations=_deviations(run, cells, F),
    )


def _seen_modes(domain: Domain, steps: int):
    """(mode, F (step, 2, 2)) of the homogeneous deformations that stay within a domain."""
    extra = domain.ranges["largest_stretch"][1] - 1.0
    shares = np.arange(1, AMPLITUDES + 1) / AMPLITUDES
    inside = domain.inside(mode_gradients(1.0 + extra * shares))
    for k, mode in enumerate(MODES):
        reached = extra * shares[inside[k]][-1] if inside[k].any() else 0.0
        if reached > SMALL * extra:
            yield mode, mode_gradients(1.0 + reached * np.arange(1, steps + 1) / steps)[k]


def _stress(material, X, F) -> Float[np.ndarray, "position point 3"]:
    """Stress of every position in every deformation."""
    P = material.stress(X, np.broadcast_to(F[:, None], (len(F), len(X), 2, 2)))
    return np.moveaxis(components(np.asarray(P, float)), 0, 1)


def _deviations(run: Run, cells, F) -> Float[np.ndarray, "sample point 3"]:
    """Of the phase's median in the posterior samples, from that of the field that they scatter about."""
    if run.posterior is None:
        return np.zeros((0, len(F), 3))
    samples = _stress(run.posterior, run.sample_positions, F).reshape(run.samples, -1, len(F), 3)[:, cells]
    best = _stress(run.equilibrium_field, run.mesh.centres[cells], F)
    return np.median(samples, axis=1) - np.median(best, axis=0)
