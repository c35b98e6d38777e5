"""The laws of the phases of an identified specimen."""

import zlib
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.material.basis_file import basis_field
from hypernode.material.domain import Domain
from hypernode.material.domain_file import domain_of
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.prediction.errors import PredictionError


@dataclass(frozen=True, kw_only=True)
class PhaseLaw:
    """The law of one phase, as one test told it.

    Attributes:
        source: the file that it is from.
        label: the number of the phase's material in that file.
        basis: terms and scale of the law.
        best: parameters (parameter,).
        samples: posterior samples of them (sample, parameter); none where the test left none.
        seen: deformations of the test; None where the file does not say.
        level: relative standard uncertainty of its level by what samples do not know, such as the thickness.
    """

    source: str
    label: int
    basis: ConvexBasis
    best: Float[np.ndarray, " parameter"]
    samples: Float[np.ndarray, "sample parameter"]
    seen: Domain | None
    level: float = 0.0


def phase_laws(file: xr.Dataset, source: str) -> list[PhaseLaw]:
    """The laws of all phases of an opened equilibrium field, the softest first.

    How stiff a law is, the size of its stress says at half of the test's largest stretch in both directions.

    Args:
        source: name of the file, for messages.

    Raises:
        PredictionError: the file holds no law of a phase.
    """
    if "basis" not in file.attrs:
        raise PredictionError(
            f"{source}: holds no laws of phases: name the run's folder, results/CASE/METHOD, or its constrained.nc"
        )
    basis, params = basis_field(file)
    if "material_label" in file:
        labels = file["material_label"].values
    elif file.attrs.get("gradual") == "true" and not np.ptp(params[1:], axis=(1, 2)).any():
        labels = np.zeros(params.shape[2], int)
    else:
        raise PredictionError(
            f"{source}: every cell has a material of its own, so that no phase has a law: identify the sheet with "
            "layers: true, or with fewer terms"
        )
    names, seen = [f"posterior.{name}" for name in basis.names], domain_of(file)
    drawn = [file[n].values[:, 0] if n in file else np.zeros((0, len(labels))) for n in names]
    drawn, half = np.stack(drawn, axis=-1), 1.0 + 0.5 * (float(file["stretch"].values.max()) - 1.0)
    laws, stiffness = [], []
    for label in np.unique(labels):
        own = labels == label
        laws.append(_of_phase(basis, params[:, 0, own], drawn[:, own], source, int(label), seen))
        stress = basis.stress(half * np.eye(2)[:, :, None], laws[-1].best[:, None])
        stiffness.append(float(np.linalg.norm(stress)))
    return [laws[k] for k in np.argsort(stiffness, kind="stable")]


def _of_phase(basis: ConvexBasis, params, drawn, source: str, label: int, seen: Domain | None) -> PhaseLaw:
    """The law of a phase, whose stiffness alone may change from place to place, as prints of one material do.

    Its level is the median over the phase. How levels scatter from place to place joins each sample: another sheet of
    the material may have any of them.

    Args:
        params: parameters of every cell of the phase (parameter, cell).
        drawn: the same of posterior samples (sample, cell, parameter).
    """
    best, samples = np.median(params, axis=1), np.median(drawn, axis=1)
    if count := len(samples):
        # As many places as there are samples, in an order without a trend and unlike that of other sheets.
        places = np.random.default_rng(zlib.crc32(source.encode())).permutation(count)
        samples[:, 0] += np.quantile(params[0], (places + 0.5) / count) - best[0]
    return PhaseLaw(source=source, label=label, basis=basis, best=best, samples=samples, seen=seen)
