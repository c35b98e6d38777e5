"""Whether the forces along two axes stand in each other's column."""

import numpy as np
from jaxtyping import Float

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.forces.matching import Component, PullRecord
from hypernode.dic.frames import first_loading, mean_gradient, mean_stretch
from hypernode.dic.series import Series
from hypernode.mechanics.loads import BOTH_AXES

#: Fewest frames that tell.
_FEWEST = 4
#: Width of a path of both elongations over its length, from which the axes are pulled one after the other. The curve of
#: a law alone bends proportional forces by less.
_WIDE = 0.2
#: Elongation until which every law has a definite stiffness. That of I2 alone, which no rubber is, loses it at 0.3.
_STABLE = 0.3
#: Product of what remains of the diagonal of a stiffness, over what it has; sheets of Poisson's ratio 0.5 have 0.75.
_DEFINITE = 0.3
#: Share of the largest elongation from which a frame tells a ratio of forces.
_FAR = 0.5
#: Factor within which an isotropic sheet with inclusions has the ratio of one without, and beyond which it has not.
_ALIKE, _UNLIKE = 1.08, 1.25
#: Smallest Poisson ratio of a sheet that is pulled far; foams have it.
_LEAST_POISSON = 0.2


def exchanged_forces(
    test: SpecimenTest, series: Series, pulls: dict[Component, PullRecord], sides: tuple[float, float]
) -> str:
    """A question where the forces along x and y seem to be exchanged; empty where they do not.

    ``force_channel: {x: ..., y: ...}`` answers it, and then nothing is asked.

    Args:
        test: with its load.
        series: the frames.
        pulls: record of each force.
        sides: of the sheet along x and y [mm], whose product with a thickness are the sections.
    """
    if test.load not in BOTH_AXES or len(pulls) < 2 or isinstance(test.force_channel, dict):
        return ""
    numbers, _ = first_loading(series, mean_stretch(series, test.load))
    numbers = numbers[np.all([pull.reached(numbers) for pull in pulls.values()], axis=0)]
    at = np.isin([frame.number for frame in series.frames], numbers)
    strain = np.stack([mean_gradient(series, axis, axis)[at] for axis in (0, 1)], axis=1)
    force = np.stack([pulls[axis, axis].forces(numbers) for axis in (0, 1)], axis=1)
    known = np.isfinite(strain).all(axis=1)
    why = _exchanged(strain[known], force[known], np.array(sides[::-1]))
    if not why:
        return ""
    names = next(iter(pulls.values())).record.channels
    said, other = ({"x": x, "y": y} for x, y in (names, names[::-1]))
    return (
        f'{why}: are they exchanged, --set "force_channel={other}", or does the sheet have fibres, and --set '
        f'"force_channel={said}" is right?'
    )


def _exchanged(strain: Float[np.ndarray, "frame 2"], force: Float[np.ndarray, "frame 2"], section: np.ndarray) -> str:
    """Why forces seem to be exchanged; empty where they do not."""
    if len(strain) < _FEWEST or not (strain[-1] > 0.0).all() or not (force[-1] > 0.0).all():
        return ""
    share = definite(strain, force / section)
    if share is not None:
        told = "the force along each axis grows while the sheet is pulled along the other one"
        return told if share < -_DEFINITE else ""
    far = strain.min(axis=1) > _FAR * strain[-1].min()
    if (force[far] <= 0.0).any():
        return ""
    low, high = isotropic_ratios(strain[far])
    ratio, other = ((each[:, 0] / each[:, 1]) for each in (force[far] / section, force[far][:, ::-1] / section))
    unlike = ((ratio > _UNLIKE * high) | (ratio < low / _UNLIKE)).all()
    if not unlike or not ((other < _ALIKE * high) & (other > low / _ALIKE)).all():
        return ""
    return (
        f"the stress along x is {ratio[-1]:.3g} times that along y at mean elongations of {strain[-1, 0]:.3g} and "
        f"{strain[-1, 1]:.3g}; a sheet without fibres has {low[-1]:.3g} to {high[-1]:.3g}, as these forces have in "
        "each other's column"
    )


def definite(strain: Float[np.ndarray, "frame 2"], stress: Float[np.ndarray, "frame 2"]) -> float | None:
    """1 - K_xy K_yx / (K_xx K_yy) of the stiffness K, or less than zero of one whose rows are exchanged.

    A stable sheet has a positive definite K. Exchanged forces exchange its rows, and so the sign of its determinant.

    Returns:
        The determinant over the larger product of a diagonal; None where the axes are pulled in proportion, which
        leaves K open.
    """
    moderate = (strain - strain[0]).max(axis=1) <= _STABLE
    strain, stress = strain[moderate], stress[moderate]
    if len(strain) < _FEWEST or not np.ptp(strain, axis=0).all():
        return None
    e = (strain - strain[0]) / np.ptp(strain, axis=0)
    size = np.linalg.svd(e - e.mean(axis=0), compute_uv=False)
    if size[1] < _WIDE * size[0]:
        return None
    K = np.linalg.lstsq(np.column_stack([e, np.ones(len(e))]), stress, rcond=None)[0][:2].T
    products = K[0, 0] * K[1, 1], K[0, 1] * K[1, 0]
    return float((products[0] - products[1]) / max(map(abs, products)))


def isotropic_ratios(strain: Float[np.ndarray, "frame 2"]) -> tuple[np.ndarray, np.ndarray]:
    """(smallest, largest) ratio of the nominal stresses along x and y of isotropic sheets at these elongations.

    The sheets are a linear one of a small Poisson ratio, and incompressible ones whose energy is I1 or I2. All between
    lie between them: T1 - T2 of any isotropic one is (l1^2 - l2^2)(W1 + l3^2 W2), with stretches l (Ogden, 1984).
    """
    a, b = (1.0 + strain).T
    c = 1.0 / (a * b)
    linear = (strain[:, 0] + _LEAST_POISSON * strain[:, 1]) / (strain[:, 1] + _LEAST_POISSON * strain[:, 0])
    first = (a**2 - c**2) / (b**2 - c**2) * b / a
    found = np.stack([linear, first, first * (b / a) ** 2])
    return found.min(axis=0), found.max(axis=0)
