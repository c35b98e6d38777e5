"""How laws that a test cannot tell from the kept one stand in the file of a constrained field."""

import dataclasses
import json
from collections.abc import Iterable

import jax.numpy as jnp
import numpy as np
import xarray as xr

from hypernode.material.basis_file import read_field
from hypernode.material.field import Material
from hypernode.material.laws import mean_of_subcells
from hypernode.storage.netcdf import units_of


def open_content(laws: Iterable) -> tuple[dict[str, tuple], dict[str, str]]:
    """(variables, attributes) of a file from which :func:`open_materials` reads the same again.

    Args:
        laws: each with ``term``, ``basis``, ``gain`` and ``samples`` (parameter, open_sample, subcell, cell).
    """
    variables, described = {}, []
    for law in laws:
        described.append({"term": law.term, "gain": law.gain, "basis": dataclasses.asdict(law.basis)})
        for name, values in zip(law.basis.names, law.samples, strict=True):
            variables[f"open_{law.term}.{name}"] = (("open_sample", "subcell", "cell"), values)
    return variables, {"open_laws": json.dumps(described)}


def open_materials(file: xr.Dataset) -> dict[str, tuple[Material, int]]:
    """{term: (all samples of the law as one material, how many)}; positions are the cell centres, once a sample."""
    found = {}
    for law in json.loads(file.attrs.get("open_laws", "[]")):
        basis, values = read_field(file, law["basis"], f"open_{law['term']}")
        params = jnp.asarray(np.moveaxis(values, 1, 2).reshape(*values.shape[:1], values.shape[2], -1))
        laws = mean_of_subcells(basis.stress), mean_of_subcells(basis.energy)
        found[law["term"]] = Material(lambda X, params=params: params, *laws, units_of(file)), values.shape[1]
    return found
