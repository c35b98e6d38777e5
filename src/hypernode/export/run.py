"""What an export is made of: the opened files of one run."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.data.lost import sheet_displacement
from hypernode.data.measurement import field_gradient, mesh_of, plane_of
from hypernode.evaluation.phases import phase_numbers
from hypernode.fem.mesh import Mesh
from hypernode.material.field import Material
from hypernode.material.files import material_of, posterior_material
from hypernode.verdict import Verdict


@dataclass(frozen=True)
class Run:
    """One run.

    Attributes:
        name: case and method, for titles.
        files: opened ``material``, ``evaluation``, ``measurement`` and ``field`` (interpolant or gradient), and
            ``constrained`` where the method has one.
    """

    name: str
    files: Mapping[str, xr.Dataset]

    @cached_property
    def mesh(self) -> Mesh:
        """The measured grid."""
        return mesh_of(self.files["measurement"])

    @property
    def plane(self) -> str:
        """``stress`` or ``strain``: the plane that the sheet was identified in."""
        return plane_of(self.files["measurement"])

    @cached_property
    def material(self) -> Material:
        """The identified material."""
        return material_of(self.files["material"])

    @cached_property
    def posterior(self) -> Material | None:
        """Its posterior samples as one material at the centres, once for each sample; None where there are none."""
        return posterior_material(self.files["constrained"]) if "constrained" in self.files else None

    @cached_property
    def equilibrium_field(self) -> Material | None:
        """The material of the field that the samples scatter about."""
        return material_of(self.files["constrained"]) if "constrained" in self.files else None

    @property
    def samples(self) -> int:
        """Number of posterior samples."""
        return 0 if self.posterior is None else self.files["constrained"].sizes["posterior_sample"]

    @property
    def sample_positions(self) -> Float[np.ndarray, "point 2"]:
        """Positions at which :attr:`posterior` is evaluated."""
        return np.tile(self.mesh.centres, (self.samples, 1))

    @cached_property
    def F(self) -> Float[np.ndarray, "step cell 2 2"]:
        """The identified deformation at the centres."""
        return np.moveaxis(field_gradient(self.files["field"]), (0, 1), (2, 3))

    @cached_property
    def displacement(self) -> Float[np.ndarray, "step node 2"]:
        """The identified displacement, or the measured one where the method computes none."""
        return sheet_displacement(self.files["measurement"], self.files.get("constrained"))

    @property
    def thickness(self) -> Float[np.ndarray, " cell"]:
        """Thickness of every cell, in the length unit."""
        measurement = self.files["measurement"]
        return float(measurement.attrs["thickness"]) * measurement["relative_thickness"].values

    @property
    def verdict(self) -> Verdict:
        """How far the run can be believed."""
        return Verdict.of(json.loads(self.files["evaluation"].attrs["verdict"]))

    @property
    def phase(self) -> np.ndarray:
        """Number of the phase of every cell, from the softest; the sides of the shape where none were looked for."""
        return phase_numbers(self.files["evaluation"])
