"""The linearised reciprocity gap: where an inclusion is, from the outline alone.

For every state v of a homogeneous sheet with shear modulus mu, tractions T(v), the gap (Ikehata 1990)

    R(v) = integral over the outline of t . v - T(v) . u  =  integral of (C - C0) e(u) : e(v),

vanishes where there is no inclusion. It is linearised about a uniform strain e0 (Born). For a small inclusion of amount
m it is then m (C1 e0) : e(v) at its place, with C1 the stiffness of unit shear modulus. The states are those of complex
potentials phi = a z^n, psi = b z^n of an incompressible sheet in plane stress, kappa = 5/3. So v is V / mu with V
known. At every place the best mu and m follow by least squares; the place that leaves least is taken. Assumed are small
strains, one compact inclusion, and known tractions all along the outline.
"""

import numpy as np
from jaxtyping import Float

from hypernode.baselines.equilibrium_gap import SMALLEST_MODULUS, BaselineError, homogeneous_modulus
from hypernode.data.loading import Loading
from hypernode.fem.gradient import mean_gradient
from hypernode.fem.mesh import EDGES, Mesh

#: Highest degree of the potentials: the strains of the states are polynomials of one degree less.
DEGREE = 4
#: Radius of the disc that shows the inclusion, over the longest side: the gap knows its place and amount, not its size.
RADIUS = 0.15
KAPPA = 5.0 / 3.0


def states(X):
    """(V (state, point, 2), stress (state, point, 2, 2)) of every state of unit shear modulus, X about the centre."""
    z = X[:, 0] + 1j * X[:, 1]
    v, stress = [], []
    for n in range(1, DEGREE + 1):
        # A rotation makes no strain: the potential phi = i z is none.
        for a, b in ((1, 0), (0, 1), (0, 1j)) if n == 1 else ((1, 0), (1j, 0), (0, 1), (0, 1j)):
            slope, bend = a * n * z ** (n - 1), a * n * (n - 1) * z ** max(n - 2, 0)
            w = (KAPPA * a * z**n - z * slope.conj() - (b * z**n).conj()) / 2.0
            total, difference = 4.0 * slope.real, 2.0 * (z.conj() * bend + b * n * z ** (n - 1))
            xx, yy, xy = 0.5 * (total - difference.real), 0.5 * (total + difference.real), 0.5 * difference.imag
            v.append(np.stack([w.real, w.imag], axis=-1))
            stress.append(np.stack([np.stack([xx, xy], axis=-1), np.stack([xy, yy], axis=-1)], axis=-2))
    return np.stack(v), np.stack(stress)


def strain_of(stress):
    """Strain of an incompressible sheet in plane stress, of shear modulus 1, from its stress."""
    trace = np.trace(stress, axis1=-2, axis2=-1)[..., None, None] * np.eye(2)
    return 0.5 * (stress - trace / 3.0)


def outline_work(mesh: Mesh, u, force):
    """(work of the forces on V, work of T(V) on u) along the outline, of every state: R(V / mu) = first / mu - second.

    Args:
        u, force: displacements and outward nodal forces over the thickness (node, 2).
    """
    V, stress = states(mesh.nodes - 0.5 * (mesh.lower + mesh.upper))
    on_u = np.zeros(len(V))
    for edge, (axis, sign) in EDGES.items():
        on = np.flatnonzero(mesh.on_edge(edge))
        on = on[np.argsort(mesh.nodes[on, 1 - axis])]
        density = np.einsum("sni,ni->sn", sign * stress[..., axis][:, on], u[on])
        on_u += np.trapezoid(density, mesh.nodes[on, 1 - axis], axis=1)
    return np.einsum("ni,sni->s", force, V), on_u


def locate(mesh: Mesh, F, u, force) -> tuple[np.ndarray, float, float]:
    """(place (2,), shear modulus of the sheet, amount: excess of the modulus times area) of an inclusion.

    Args:
        F: [i, J, step, cell].
        u, force: displacements and outward nodal forces over the thickness (step, node, 2).
    """
    _, stress = states(mesh.centres - 0.5 * (mesh.lower + mesh.upper))
    strain, mean = strain_of(stress), np.moveaxis(mean_gradient(mesh, F)[..., 0], -1, 0)
    rows = []
    for step in range(len(u)):
        e0 = 0.5 * (mean[step] + mean[step].T) - np.eye(2)
        unit = 2.0 * (e0 + np.trace(e0) * np.eye(2))
        on_V, on_u = outline_work(mesh, u[step], force[step])
        at = np.einsum("ij,scij->sc", unit, strain)
        size = np.linalg.norm(e0) * np.sqrt(np.mean(np.sum(stress**2, axis=(2, 3)), axis=1))
        rows.append([on_V / size, on_u / size, at / size[:, None]])
    on_V, on_u, at = (np.concatenate(each) for each in zip(*rows, strict=True))
    # on_V / mu - (m / mu) at = on_u, by normal equations at every place.
    aa, bb, ab = on_V @ on_V, np.sum(at**2, axis=0), on_V @ at
    ay, by = on_V @ on_u, on_u @ at
    inverse, ratio = (bb * ay - ab * by) / (aa * bb - ab**2), (aa * by - ab * ay) / (aa * bb - ab**2)
    left = np.sum((on_V[:, None] * inverse + at * ratio - on_u[:, None]) ** 2, axis=0)
    best = np.argmin(left)
    return mesh.centres[best], float(1.0 / inverse[best]), float(-ratio[best] / inverse[best])


def reciprocity_gap_moduli(mesh: Mesh, loading: Loading, F, u, force) -> Float[np.ndarray, " cell"]:
    """Coefficient of every cell: that of the sheet, and of a disc with the inclusion's place and amount.

    Args:
        F: [i, J, step, cell].
        u, force: displacements and outward nodal forces over the thickness (step, node, 2); None where unknown.

    Raises:
        BaselineError: no tractions are known along the outline, or the forces are those of no material.
    """
    if force is None:
        raise BaselineError("the reciprocity gap needs tractions along the outline, and a load cell tells resultants")
    level = homogeneous_modulus(mesh, loading, F)
    place, mu, amount = locate(mesh, F, u, force)
    disc = np.linalg.norm(mesh.centres - place, axis=1) <= RADIUS * mesh.size.max()
    # A neo-Hookean sheet of coefficient c has the shear modulus 2 c.
    moduli = 0.5 * (mu + amount * disc / mesh.areas[disc].sum())
    return np.maximum(moduli, SMALLEST_MODULUS * level)
