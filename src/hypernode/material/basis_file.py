"""How a field of convex-basis parameters stands in a file."""

import dataclasses
import json
from collections.abc import Mapping

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.mechanics.convex_basis import ConvexBasis


def basis_field(file: xr.Dataset) -> tuple[ConvexBasis, Float[np.ndarray, "parameter part cell"]]:
    """The convex basis of a constrained field and its parameters in the parts of every cell, row by row."""
    return read_field(file, json.loads(file.attrs["basis"]), "basis")


def read_field(file: xr.Dataset, described: Mapping, prefix: str) -> tuple[ConvexBasis, np.ndarray]:
    """A convex basis as a file describes it, and its parameters, the first axis, from variables with a prefix."""
    basis = ConvexBasis(tuple(described["terms"]), described["invariant_scale"])
    return basis, np.stack([file[f"{prefix}.{name}"].values for name in basis.names])


def basis_content(
    basis: ConvexBasis, params: Float[np.ndarray, "parameter part cell"]
) -> tuple[dict[str, tuple], dict[str, str]]:
    """(variables, attributes) of a file from which :func:`basis_field` reads the same again."""
    variables = {
        f"basis.{name}": (("subcell", "cell"), values) for name, values in zip(basis.names, params, strict=True)
    }
    return variables, {"material_kind": "convex_basis", "basis": json.dumps(dataclasses.asdict(basis))}
