"""How the deformations that a test has seen stand in a file."""

import json

import numpy as np
import xarray as xr

from hypernode.material.domain import Domain


def domain_of(file: xr.Dataset) -> Domain | None:
    """The domain that a file of a material holds, or None."""
    if "deformation_seen" not in file:
        return None
    names = json.loads(file.attrs["deformation_measures"])
    return Domain(dict(zip(names, file["deformation_seen"].values, strict=True)))


def domain_content(domain: Domain) -> tuple[dict[str, np.ndarray], dict[str, list[str]]]:
    """(variables, attributes) of a file from which :func:`domain_of` reads the same again."""
    return {"deformation_seen": np.array(list(domain.ranges.values()))}, {"deformation_measures": list(domain.ranges)}
