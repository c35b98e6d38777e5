"""The deformations that a test has seen: beyond them, an identified material is extrapolated.

NumPy alone, without the shapes in the types: this module is part of the file that an exported material is.
"""

import numpy as np

#: How a point is deformed: principal stretches, ratio of areas and invariants of an incompressible sheet; then, of a
#: material that has a direction, stretches of lines at so many degrees from x.
ISOTROPIC = ("largest_stretch", "smallest_stretch", "area_ratio", "I1", "I2")
DIRECTIONS = {"stretch_0": 0.0, "stretch_45": 45.0, "stretch_90": 90.0, "stretch_135": 135.0}
#: Relative distance beyond a bound that may be the rounding of single precision.
ROUNDING = 1e-5


def deformation_measures(F):
    """{name: values} of every measure of in-plane deformation gradients F [..., 2, 2]."""
    F = np.asarray(F, float)
    C = np.swapaxes(F, -1, -2) @ F
    trace, J = C[..., 0, 0] + C[..., 1, 1], F[..., 0, 0] * F[..., 1, 1] - F[..., 0, 1] * F[..., 1, 0]
    radius = np.sqrt((0.5 * (C[..., 0, 0] - C[..., 1, 1])) ** 2 + C[..., 0, 1] ** 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        found = {
            "largest_stretch": np.sqrt(0.5 * trace + radius),
            "smallest_stretch": np.sqrt(np.maximum(0.5 * trace - radius, 0.0)),
            "area_ratio": J,
            "I1": trace + 1.0 / J**2,
            "I2": J**2 + trace / J**2,
        }
    for name, degrees in DIRECTIONS.items():
        line = np.array([np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))])
        found[name] = np.sqrt(np.einsum("i,...ij,j->...", line, C, line))
    return found


class Domain:
    """Ranges of the measures of deformation over a test.

    Attributes:
        ranges: {name of a measure: (smallest, largest)}; the undeformed sheet is in every one.
    """

    def __init__(self, ranges):
        self.ranges = {name: (float(low), float(high)) for name, (low, high) in ranges.items()}

    @classmethod
    def of(cls, F, directional):
        """That of the deformation gradients F [..., 2, 2] of a test; those that are folded or not finite are left out.

        Args:
            F: at the points of the sheet, in every state of the test.
            directional: whether the material has a direction, so that a stretch along x says little of one along y.
        """
        F = np.asarray(F, float).reshape(-1, 2, 2)
        F = F[np.isfinite(F).all(axis=(1, 2))]
        F = F[np.linalg.det(F) > 0.0]
        measures = deformation_measures(np.concatenate([np.eye(2)[None], F]))
        names = ISOTROPIC + (tuple(DIRECTIONS) if directional else ())
        return cls({name: (measures[name].min(), measures[name].max()) for name in names})

    def inside(self, F):
        """Whether each of the deformation gradients F [..., 2, 2] is in all ranges."""
        beyond = [excess > 0.0 for excess in self._excess(deformation_measures(F)).values()]
        return ~np.any(beyond, axis=0)

    def remark(self, F):
        """A sentence on the deformation gradients F [..., 2, 2] that are beyond the ranges, or "" where none is."""
        measures = deformation_measures(F)
        excess = self._excess(measures)
        share = np.mean(np.any([each > 0.0 for each in excess.values()], axis=0))
        if share == 0.0:
            return ""
        name = next(name for name in self.ranges if np.any(excess[name] > 0.0))
        asked = measures[name].ravel()[np.nanargmax(excess[name])]
        low, high = self.ranges[name]
        return (
            f"{max(100.0 * share, 0.1):.1f} % of the deformations asked for are beyond what the test has seen, where "
            f"the material is extrapolated: the {name.replace('_', ' ')} is {asked:.4g}, and in the test it was "
            f"{low:.4g} to {high:.4g}"
        )

    def _excess(self, measures):
        """{name: by how much each value is beyond its range, positive where it is}."""
        margin = {name: ROUNDING * max(abs(low), abs(high)) for name, (low, high) in self.ranges.items()}
        return {
            name: np.maximum(low - measures[name], measures[name] - high) - margin[name]
            for name, (low, high) in self.ranges.items()
        }
