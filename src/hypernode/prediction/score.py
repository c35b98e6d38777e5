"""A prediction against the test of its sheet."""

from dataclasses import asdict, dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.data.measurement import measured_displacement, scatter_of_steps, stress_resultants
from hypernode.fem.mesh import EDGE_NAMES
from hypernode.identification.resultants import EdgeForce
from hypernode.prediction.predict import Prediction

#: Standard deviations up to which a difference is expected.
SPREADS = 2.0


@dataclass(frozen=True, kw_only=True)
class Score:
    """How far a prediction is from what was measured; None where the test has no forces, or no displacement inside.

    Attributes:
        force_error: by step, norm of the differences of all measured resultants over the norm of these.
        force_within: share of the resultants that are within two spreads.
        displacement_error: by step, the same of points that no edge holds.
        displacement_noise: by step, what noise alone makes of that.
        displacement_within: share of their components that are within two spreads.
    """

    force_error: list[float] | None
    force_within: float | None
    displacement_error: list[float] | None
    displacement_noise: list[float] | None
    displacement_within: float | None

    def stored(self) -> dict:
        """As an attribute of a file."""
        return asdict(self)


def score(measurement: xr.Dataset, prediction: Prediction) -> Score:
    """Compare with the test that a measurement holds.

    A spread is that of the prediction and that of the measurement together. Displacements have noise; forces have the
    scatter, the gain and the zero of a load cell.

    Args:
        measurement: opened.
    """
    measured = measurement.attrs["forces"] == "measured"
    force_error, force_within = _forces(measurement, prediction) if measured else (None, None)
    displacement_error, noise, displacement_within = _displacements(measurement, prediction)
    return Score(
        force_error=force_error,
        force_within=force_within,
        displacement_error=displacement_error,
        displacement_noise=noise,
        displacement_within=displacement_within,
    )


def _forces(measurement: xr.Dataset, prediction: Prediction) -> tuple[list[float], float]:
    measured = stress_resultants(measurement)
    scale = measurement["edge_force"].values / measured
    missed, size, within = np.zeros(len(measured)), np.zeros(len(measured)), []
    for force in prediction.problem.forces:
        at = _place(force, prediction)
        factor = scale[at]
        difference = prediction.force[at] - factor * force.value
        spread = np.hypot(prediction.force_spread[at], factor * np.linalg.norm([force.sigma, force.gain, force.offset]))
        missed[force.step] += difference**2
        size[force.step] += (factor * force.value) ** 2
        within.append(abs(difference) <= SPREADS * spread)
    return np.sqrt(missed / size).tolist(), float(np.mean(within))


def _place(force: EdgeForce, prediction: Prediction) -> tuple[int, int, int]:
    """(step, edge, component) of a measured resultant."""
    mesh, component = prediction.problem.mesh, force.channel[1]
    held = force.direction.reshape(-1, 2)[:, component] > 0
    edges = [mesh.on_edge(edge) for edge in EDGE_NAMES]
    return force.step, next(e for e, each in enumerate(edges) if np.array_equal(each, held)), component


def _displacements(measurement: xr.Dataset, prediction: Prediction):
    measured, noise = measured_displacement(measurement), scatter_of_steps(measurement)
    mesh = prediction.problem.observations.grid
    inside = ~np.any([mesh.on_edge(edge) for edge in EDGE_NAMES], axis=0)
    if not np.isfinite(measured[:, inside]).any():
        return None, None, None
    errors, shares, within = [], [], []
    for step, boundary in enumerate(prediction.problem.observations.boundaries):
        seen, size = boundary.observed, np.linalg.norm(_picked(measured[step], boundary.observed))
        difference = _picked(prediction.u[step] - measured[step], seen)
        of_noise = _picked(np.broadcast_to(noise[step], measured[step].shape), seen)
        spread = np.hypot(_picked(prediction.u_spread[step], seen), of_noise)
        errors.append(float(np.linalg.norm(difference) / size))
        shares.append(float(np.linalg.norm(of_noise) / size))
        within.append(np.abs(difference) <= SPREADS * spread)
    return errors, shares, float(np.mean(np.concatenate(within)))


def _picked(values: Float[np.ndarray, "node 2"], dofs) -> Float[np.ndarray, " dof"]:
    return values.ravel()[dofs]
