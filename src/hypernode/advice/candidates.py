"""Further tests that a sheet could be put through, at the size of the one that was done."""

import json
from dataclasses import dataclass

import numpy as np
import xarray as xr

from hypernode.data.loading import load_kind
from hypernode.mechanics.loads import RESULTANTS, Load, make_load

#: How much larger the larger test is: as far beyond what was seen as a law can be asked that was seen to two thirds.
LARGER = 1.5
#: Displacement gradients that differ by less are of one test: a machine is not set more exactly.
SAME = 1e-3


@dataclass(frozen=True)
class Candidate:
    """A further test.

    Attributes:
        name: what it is called.
        load: its load case; None of the present test, done again.
    """

    name: str
    load: Load | None


def candidates(measurement: xr.Dataset, larger: float = LARGER) -> list[Candidate]:
    """The tests that are compared: standard ones to the largest stretch seen, the same again, and to a larger one.

    Standard tests have the load steps of the first load case, and one that was done already is left out.

    Args:
        measurement: opened file of the present test.
        larger: displacements of the larger tests over those of the present one.
    """
    done = present_loads(measurement)
    largest = float(np.abs(measurement["H"].values).max())
    first = np.abs(done[0][1].H).reshape(len(done[0][1].H), 4).max(axis=1)
    amounts = largest * first / first.max()
    others = [each for each in standard_loads(amounts) if not any(_alike(each.load, load) for _, load in done)]
    name = " and ".join(dict.fromkeys(name for name, _ in done))
    further = [Candidate(f"{name}, larger", Load(load.kind, larger * load.H)) for name, load in done]
    return [*others, *further, Candidate(f"{name} again", None)]


def standard_loads(amounts) -> list[Candidate]:
    """The standard tests, pulled or sheared by these displacement gradients (step,)."""
    stretches = 1.0 + np.asarray(amounts)
    straight = np.ones_like(stretches)
    return [
        Candidate("equibiaxial", make_load("biaxial", np.stack([stretches, stretches], axis=1))),
        Candidate("uniaxial x", make_load("uniaxial_x", stretches)),
        Candidate("uniaxial y", make_load("uniaxial_y", stretches)),
        Candidate("strip x", make_load("biaxial", np.stack([stretches, straight], axis=1))),
        Candidate("strip y", make_load("biaxial", np.stack([straight, stretches], axis=1))),
        Candidate("shear", make_load("shear", stretches)),
    ]


def present_loads(measurement: xr.Dataset) -> list[tuple[str, Load]]:
    """(name, load) of every load case of a measurement, as its held edges and their displacements tell.

    Of what no edge holds the mean displacement gradient is no part of the load.
    """
    names, numbers = json.loads(measurement.attrs["load_cases"]), measurement["load_case"].values
    found = []
    for number, name in enumerate(names):
        steps = np.flatnonzero(numbers == number)
        H = measurement["H"].values[steps]
        kind = load_kind(measurement["edge_constrained"].values[steps[0]] > 0, H)
        prescribed = np.zeros((2, 2), dtype=bool)
        for i, J in RESULTANTS[kind] if kind != "general" else np.ndindex(2, 2):
            prescribed[i, J] = True
        found.append((name, Load(kind, np.where(prescribed, H, 0.0))))
    return found


def _alike(one: Load, other: Load) -> bool:
    """Whether two loads hold the same edges and move them as far in the end."""
    held = set(one.constrained) == set(other.constrained)
    return held and bool(np.abs(one.H[-1] - other.H[-1]).max() <= SAME)
