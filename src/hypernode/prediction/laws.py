"""The laws of the phases of an identified specimen."""

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
    """

    source: str
    label: int
    basis: ConvexBasis
    best: Float[np.ndarray, " parameter"]
    samples: Float[np.ndarray, "sample parameter"]
    seen: Domain | None


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
    if "material_label" not in file:
        raise PredictionError(
            f"{source}: every cell has a material of its own, so that no phase has a law: identify the sheet with "
            "layers: true, or with fewer terms"
        )
    basis, params = basis_field(file)
    labels = file["material_label"].values
    names, none = [f"posterior.{name}" for name in basis.names], np.zeros((0, len(basis.names)))
    has_samples, seen = names[0] in file, domain_of(file)
    half = 1.0 + 0.5 * (float(file["stretch"].values.max()) - 1.0)
    laws, stiffness = [], []
    for label in np.unique(labels):
        cell = int(np.flatnonzero(labels == label)[0])
        samples = np.stack([file[n].values[:, 0, cell] for n in names], axis=-1) if has_samples else none
        laws.append(
            PhaseLaw(source=source, label=int(label), basis=basis, best=params[:, 0, cell], samples=samples, seen=seen)
        )
        stress = basis.stress(half * np.eye(2)[:, :, None], params[:, 0, cell][:, None])
        stiffness.append(float(np.linalg.norm(stress)))
    return [laws[k] for k in np.argsort(stiffness, kind="stable")]
