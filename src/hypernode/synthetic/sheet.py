"""The sheet of a synthetic test: its mesh and the material of every cell."""

from collections.abc import Mapping

import numpy as np

from hypernode.config.cases import Case
from hypernode.fem.mesh import EDGES, Mesh, rectilinear
from hypernode.mechanics.closed_forms import NEUTRAL
from hypernode.mechanics.parameters import PARAMETERS
from hypernode.synthetic.geometry import Shape

PHASES = ("matrix", "inclusion")


def grid_lines(length: float, cells: int, ratio: float):
    """Coordinates of a line of cells whose sides grow geometrically, the last ``ratio`` times the first."""
    sides = ratio ** (np.arange(cells) / max(cells - 1, 1))
    lines = np.concatenate([[0.0], np.cumsum(sides)])
    return length * lines / lines[-1]


def make_mesh(case: Case, hole: Shape | None) -> Mesh:
    """Rectilinear mesh of a synthetic case; ``hole`` is where there is no material."""
    x, y = (grid_lines(*each) for each in zip(case.size, case.cells, case.spacing, strict=True))
    if hole is None:
        return rectilinear(x, y)
    centres = np.stack(np.meshgrid(0.5 * (x[1:] + x[:-1]), 0.5 * (y[1:] + y[:-1])), axis=-1).reshape(-1, 2)
    keep = hole(centres / case.size) <= 0.5
    mesh = rectilinear(x, y, keep.reshape(len(y) - 1, -1))
    if not all(mesh.on_edge(edge).any() for edge in EDGES) or keep.sum() < 4:
        raise ValueError("the hole leaves no sheet to hold: it must stay inside the edges")
    return mesh


def cell_parameters(shares, phases):
    """Models and parameters of every cell.

    Args:
        shares: share of each phase in each cell (phase, cell), summing to one. Parameters are mixed
            linearly, which needs the phases that meet in a cell to be of one model.
        phases: configured materials.

    Returns:
        (model names, {"model": index per cell, parameter: value per cell}); fibre angles in rad.
    """
    models = tuple(dict.fromkeys(m.model for m in phases))
    names = list(dict.fromkeys(name for m in phases for name in PARAMETERS[m.model]))
    largest = np.argmax(shares, axis=0)
    model = np.array([models.index(m.model) for m in phases])[largest]
    meeting = [{phases[k].model for k in np.flatnonzero(shares[:, c])} for c in np.flatnonzero(shares.max(axis=0) < 1)]
    if any(len(together) > 1 for together in meeting):
        raise ValueError(
            f"a gradient between {models[0]} and {models[1]} has no meaning: use one model for both phases"
        )
    values = {"model": model.astype(float)}
    for name in names:
        total = np.zeros(shares.shape[1])
        for part, material in zip(shares, phases, strict=True):
            value = material.parameters.get(name, NEUTRAL.get(name, 0.0))
            total += part * (np.deg2rad(value) if name == "fibre_angle" else value)
        values[name] = total
    return models, values


def phase_shares(case: Case, shapes: Mapping[str, Shape], X) -> tuple[np.ndarray, list[str]]:
    """(share of each phase in each cell (phase, cell), names of their materials), the matrix first.

    Args:
        shapes: by the name of a geometry.
        X: cell centres in the unit square (cell, 2).

    Raises:
        ValueError: a geometry holds no cell's centre.
    """
    drawn = [(case.geometry, case.inclusion)] if case.inclusion else []
    drawn += [(phase.geometry, phase.material) for phase in case.further_phases]
    shares, names = np.ones((1, len(X))), [case.matrix]
    for geometry, material in drawn:
        weight = shapes[geometry](X)
        if not weight.any():
            raise ValueError(f"the geometry '{geometry}' holds no cell's centre: make it larger, or cells smaller")
        shares = np.concatenate([shares * (1.0 - weight), weight[None]])
        names.append(material)
    return shares, names
