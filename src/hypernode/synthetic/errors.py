"""Errors of a synthetic measurement: of displacements, which points may share, and of forces."""

import numpy as np
from jaxtyping import Float, Int
from scipy.ndimage import gaussian_filter

from hypernode.config.synthetic import Noise
from hypernode.fem.mesh import EDGE_NAMES, EDGES, Mesh

#: Streams of random numbers beside those of repeats, which are numbered from 0.
_OUTLIERS, _FORCES = 1_000_000, 2_000_000


def _stream(noise: Noise, number: int) -> np.random.Generator:
    """A stream of its own, so that one more repeat or kind of error leaves the others as they were."""
    return np.random.default_rng(np.random.SeedSequence([noise.seed, number]))


def with_noise(
    mesh: Mesh, u: Float[np.ndarray, "step node 2"], noise: Noise
) -> Float[np.ndarray, "repeat step node 2"]:
    """Repeats of a measurement, each with normally distributed errors of its own and outliers.

    Args:
        mesh: the measured grid.
        u: displacement without noise.
    """
    measured = np.repeat(u[None], noise.repeats, axis=0)
    for repeat in range(noise.repeats):
        if noise.sigma > 0.0:
            measured[repeat] += noise.sigma * _errors(mesh, u.shape, noise.correlation_length, _stream(noise, repeat))
        if noise.outliers > 0.0:
            random = _stream(noise, _OUTLIERS + repeat)
            where = np.nonzero(random.uniform(size=u.shape[:2]) < noise.outliers)
            angle = random.uniform(0.0, 2.0 * np.pi, len(where[0]))
            measured[repeat][where] += noise.outlier_size * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return measured


def _errors(mesh: Mesh, shape, length: float, random: np.random.Generator):
    """Errors (step, node, 2) of unit variance, smoothed over the grid by a Gaussian of this many steps."""
    if length == 0.0:
        return random.normal(size=shape)
    x, y = mesh.lines
    white = random.normal(size=(shape[0], len(y), len(x), 2))
    smooth = gaussian_filter(white, (0.0, length, length, 0.0), mode="wrap")
    # A point's variance is the sum of the squared weights of the filter.
    point = np.zeros((len(y), len(x)))
    point[0, 0] = 1.0
    smooth /= np.linalg.norm(gaussian_filter(point, length, mode="wrap"))
    return smooth.reshape(shape[0], -1, 2)[:, mesh.places]


def with_force_errors(
    force: Float[np.ndarray, "step edge 2"], load_case: Int[np.ndarray, " step"], noise: Noise
) -> Float[np.ndarray, "step edge 2"]:
    """Resultants as load cells read them, one for each load case, component and normal of the edges.

    A load cell's gain and zero are off for all steps of a load case, its noise is each step's own, and opposite edges
    read alike.
    """
    if noise.force == noise.force_gain == noise.force_offset == 0.0:
        return force
    read, random = force.copy(), _stream(noise, _FORCES)
    for case in np.unique(load_case):
        steps = np.flatnonzero(load_case == case)
        for normal in range(2):
            edges = [EDGE_NAMES.index(edge) for edge, (axis, _) in EDGES.items() if axis == normal]
            signs = [EDGES[EDGE_NAMES[edge]][1] for edge in edges]
            for i in range(2):
                gain, zero = random.normal(size=2) * (noise.force_gain, noise.force_offset)
                own = random.normal(size=len(steps)) * noise.force
                here = force[steps][:, edges, i]
                largest = np.abs(here[np.isfinite(here)]).max(initial=0.0)
                read[np.ix_(steps, edges, [i])] = (
                    here * (1.0 + gain + own)[:, None] + np.array(signs) * zero * largest
                )[:, :, None]
    return read
