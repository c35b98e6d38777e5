"""Published sets of peers in a folder of the user's: identified, scored by the peers' own measure, on one page.

    python -m benchmarks.peers FOLDER

A set that is absent is named with where to get it. What was identified and scored once stays in ``.cache/peers``
until the set or any code that it rests on changes. The page is ``docs/peers.md``.
"""

import hashlib
import json
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from hypernode.pipeline.compiler import set_up_compiler

set_up_compiler(float64=True)

import numpy as np

from hypernode.config.methods import Constrained
from hypernode.dic.arrays import arrays_in
from hypernode.fem.mesh import EDGE_NAMES, rectilinear
from hypernode.material.basis_file import basis_field
from hypernode.mechanics.loads import CONSTRAINED
from hypernode.stages import constrained
from hypernode.storage.netcdf import SYNTHETIC_UNITS, StorageError, read, sha256, write
from hypernode.storage.provenance import code_hash

ROOT = Path(__file__).resolve().parents[1]
PAGE, CACHE = ROOT / "docs" / "peers.md", ROOT / ".cache" / "peers"
#: A field of cells whose volume may change, which neither knows the law nor where materials are.
SETTINGS = Constrained(terms=["J"], iterations=30)
#: Largest mean strain of a test that is used.
LARGEST = 0.3


@dataclass(frozen=True, kw_only=True)
class PeerSet:
    """A set that a peer published.

    Attributes:
        file: its name in the folder.
        what: words on it.
        where: from where it can be had.
        measure: the peer's own, in words.
        stated: what the peer states by it, with what it is told.
        score: (arrays of the file, where work files go) -> our figure in words; None where it is not run here.
    """

    file: str
    what: str
    where: str
    measure: str
    stated: str
    score: Callable | None


def _measurement(path: Path, X, u, kind: str, stretch, force, outline: str, mesh: str) -> None:
    """A noise-free test on a grid (row, column, 2): u (step, row, column, 2), forces (step, edge, 2) or None."""
    grid = rectilinear(X[0, :, 0], X[:, 0, 1])
    steps = len(u)
    held = np.zeros((steps, 4, 2))
    for name, component in CONSTRAINED[kind]:
        held[:, EDGE_NAMES.index(name), component] = 1.0
    assumed = np.full((steps, 4, 2), np.nan)
    # Convention of a test without a load cell: a force of one.
    assumed[:, [0, 1], 0], assumed[:, [2, 3], 1] = [-1.0, 1.0], [-1.0, 1.0]
    H = np.stack([_mean_gradient(X, each) for each in u])
    variables = {
        **{"X": grid.nodes, "cells": grid.cells, "corners": np.stack([grid.lower, grid.upper])},
        **{"u_measured": u.reshape(1, steps, -1, 2), "relative_thickness": np.ones(len(grid.cells)), "H": H},
        **{"noise_level": np.zeros((steps, 2)), "noise_scatter": np.zeros((steps, 2)), "relaxation": np.ones(steps)},
        **{"load_case": np.zeros(steps, int), "stretch": stretch, "edge_constrained": held},
        "edge_force": assumed if force is None else force,
    }
    attributes = {
        **{"noise_uncertainty": 0.0, "force_uncertainty": 0.0, "force_gain_uncertainty": 0.0},
        **{"force_offset_uncertainty": 0.0, "correlation_window": 0.0, "thickness": 1.0, "outline": outline},
        **{"mesh": mesh, "forces": "assumed" if force is None else "measured", "units": SYNTHETIC_UNITS},
    }
    write(path, variables, "a peer's set", attributes)


def _mean_gradient(X, u):
    """Mean displacement gradient of the bounding rectangle, from the means over opposite edges."""
    size = X[-1, -1] - X[0, 0]
    across = (u[:, -1] - u[:, 0]).mean(axis=0) / size[0], (u[-1] - u[0]).mean(axis=0) / size[1]
    return np.stack(across, axis=-1)


def _stiffness(work: Path, name: str, stretch: float):
    """(modulus of shear at rest, size of the stress when stretched equally both ways) of every cell (row, column)."""
    found = _field(name, work / "measurement.nc", work / "field.nc")
    basis, params = basis_field(found)
    F = stretch * np.eye(2)[:, :, None, None] * np.ones(params.shape[1:])
    size = np.linalg.norm(np.asarray(basis.stress(F, params)), axis=(0, 1)).mean(axis=0)
    shear = np.exp(params[basis.names.index("log_level")]).mean(axis=0)
    cells = [len(np.unique(found["X"].values[:, k])) - 1 for k in (1, 0)]
    return shear.reshape(cells), size.reshape(cells)


def _field(name: str, measurement: Path, field: Path):
    """The identified field of a measurement, made where there is none of this very one."""
    try:
        return read(field)
    except StorageError:
        constrained.run(SETTINGS, name, str(measurement), str(field), {"rule": "peers"})
        return read(field)


def _relative(found, true) -> float:
    """Relative L2 error of a map that is known up to one factor."""
    factor = np.sum(found * true) / np.sum(found**2)
    return float(np.linalg.norm(factor * found - true) / np.linalg.norm(true))


def _cells(nodal):
    """Means of nodal values over cells (row, column)."""
    return 0.25 * (nodal[1:, 1:] + nodal[1:, :-1] + nodal[:-1, 1:] + nodal[:-1, :-1])


def smooth_field(arrays, work: Path) -> str:
    """A modulus that changes smoothly, stretched along both axes, without forces."""
    X, u = arrays["X"], arrays["u"]
    X, u, E = _upward(X, u, arrays["modulus"])
    # Its 51 x 51 points are the nodes of the elements that it was computed with.
    _measurement(work / "measurement.nc", X, u, "equibiaxial", np.full(len(u), 1.4), None, "edge", "measured_grid")
    shear, size = (100.0 * _relative(each, _cells(E)) for each in _stiffness(work, "smooth field", 1.4))
    said = f"{shear:.2g} % of the modulus of shear, {size:.2g} % of the stress at a stretch of 1.4"
    return f"{said}; up to one factor, law and nu not told"


def digit(arrays, work: Path) -> str:
    """A digit of a modulus of 1 to 100, pulled at one end, with forces."""
    X, u, E = _upward(arrays["X"], arrays["u"], arrays["E"])
    way = np.asarray(arrays["disp_top"], float)
    used = np.flatnonzero((way > 0.0) & (way <= LARGEST * np.ptp(X[..., 1])))
    chosen = used[np.linspace(0, len(used) - 1, 3).round().astype(int)]
    force = np.full((len(chosen), 4, 2), np.nan)
    top = np.abs(np.asarray(arrays["force_top"], float)[chosen])
    force[:, 3, 1], force[:, 2, 1] = top, -top
    # Positions are centres of pixels: the outline of the grid lies within the sheet. Finer elements take a quarter of
    # an hour and more for this contrast, so that the grid counts as the one of the elements.
    stretch = 1.0 + way[chosen] / np.ptp(X[..., 1])
    _measurement(work / "measurement.nc", X, u[chosen], "clamped_y", stretch, force, "cut", "measured_grid")
    (found, _), true = _stiffness(work, "digit", 1.1), _cells(E)
    middle = np.sqrt(found.min() * found.max())
    stiff, known = found > middle, true > np.sqrt(true.min() * true.max())
    shape = 2.0 * np.sum(stiff & known) / (stiff.sum() + known.sum())
    return (
        f"Dice {shape:.2f}; correlation of log E {np.corrcoef(np.log(found).ravel(), np.log(true).ravel())[0, 1]:.2f}"
    )


def _upward(X, u, field):
    """Rows along y and columns along x, both increasing: positions, displacements and a nodal field."""
    if np.ptp(X[0, :, 0]) < np.ptp(X[:, 0, 0]):
        X, u, field = np.swapaxes(X, 0, 1), np.swapaxes(u, 1, 2), field.T
    if X[0, 0, 1] > X[-1, 0, 1]:
        X, u, field = X[::-1], u[:, ::-1], field[::-1]
    if X[0, 0, 0] > X[0, -1, 0]:
        X, u, field = X[:, ::-1], u[:, :, ::-1], field[:, ::-1]
    return X.astype(float), u.astype(float), field.astype(float)


SETS = (
    PeerSet(
        file="smooth_random_field_neo_hookean.npz",
        what="smooth random modulus, neo-Hookean, plane strain, no forces, no noise",
        where="GRF_equi_disp0.4_neo.npy of github.com/lu-group/pinn-heterogeneous-material (Apache-2.0), as arrays X, "
        "u, modulus",
        measure="relative L2 error of the modulus",
        stated="below 5 % with noise up to 10 %, told strains, the law, nu and bounds of E; 500 000 iterations "
        "(2402.10741)",
        score=smooth_field,
    ),
    PeerSet(
        file="mechanical_mnist_train1.npz",
        what="a digit, contrast 100 : 1, one datum a pixel of the material",
        where="github.com/elejeune11/Mechanical-MNIST-Transfer-Learning (MIT; data CC BY-SA), as arrays X, u, E, "
        "force_top, disp_top",
        measure="none for the inverse problem; Dice of the stiff pixels here",
        stated="-",
        score=digit,
    ),
    PeerSet(
        file="challenge/000.npz",
        what="2025 Mechanical MNIST Challenge, 90 printed sheets",
        where="github.com/fsahli/mechanical-MNIST-challenge (CC BY 4.0), folder training-set as challenge",
        measure="mean of Dice over the classes in either map",
        stated="no entry published",
        score=None,
    ),
    PeerSet(
        file="fe_mad",
        what="printed sheets of two phases, laws carried to 22 samples",
        where="the authors of arXiv 2606.05199",
        measure="forces of unseen samples",
        stated="both phases, geometry given",
        score=None,
    ),
    PeerSet(
        file="hetero_euclid",
        what="finite-element sheets of segments, several noises",
        where="the authors of arXiv 2509.11784",
        measure="labels of segments, laws",
        stated="segments and laws from one test",
        score=None,
    ),
)


def scored(each: PeerSet, folder: Path) -> tuple[str, str, str]:
    """(our figure, how it ended, processor time) of a set, from the cache where nothing has changed."""
    path = folder / each.file
    if not path.exists():
        return f"absent: get it from {each.where}", "-", "-"
    if each.score is None:
        return "there, and not run here: takes more than a few minutes", "-", "-"
    key = hashlib.sha256((sha256(path) + code_hash(__file__)).encode()).hexdigest()
    work = CACHE / path.stem / key[:16]
    if not (work / "score.json").is_file():
        work.mkdir(parents=True, exist_ok=True)
        began = time.process_time()
        figure = each.score(arrays_in(path), work)
        took = f"{time.process_time() - began:.0f} s"
        (work / "score.json").write_text(json.dumps({"figure": figure, "time": took}) + "\n")
    held = json.loads((work / "score.json").read_text())
    return held["figure"], _ending(work / "field.nc"), held["time"]


def _ending(field: Path) -> str:
    """How the descent to a field ended, with what it leaves of the displacements."""
    said = read(field).attrs
    return f"{said['ending']}, displacements missed by {json.loads(said['misfits'])['displacement']:.2g}"


def page(rows) -> str:
    """The page, of (set, our figure, how it ended, processor time)."""
    lines = [
        "# Peers' own sets",
        "",
        "Each set is what a peer published. Ours stands beside what the peer states, by the peer's measure.",
        "`make peers PEERS=FOLDER` makes this page from the sets in a folder. A set that is absent says where it is.",
        "",
        "| set | measure | the peer states | hypernode | how it ended | processor time |",
        "|---|---|---|---|---|---|",
        *(
            f"| {each.what} | {each.measure} | {each.stated} | {figure} | {ending} | {took} |"
            for each, figure, ending, took in rows
        ),
        "",
        "Displacements are missed by so many times what elements on the grid are trusted with; 1 explains a test.",
        "A field that misses by much more is no answer.",
        "",
        "Sheets of the 2025 Mechanical MNIST Challenge are labelled one by one:",
        "[label a test of the challenge](how-to/challenge.md).",
    ]
    return "\n".join(lines) + "\n"


def main(folder: Path) -> None:
    """Score every set of a folder and write the page."""
    rows = []
    for each in SETS:
        rows.append((each, *scored(each, folder)))
        print(f"{each.file}: {rows[-1][1]}", flush=True)
    PAGE.write_text(page(rows))
    print(PAGE.relative_to(ROOT))


if __name__ == "__main__":
    if len(sys.argv) != 2 or not Path(sys.argv[1]).is_dir():
        sys.exit("usage: python -m benchmarks.peers FOLDER, a folder with the sets that you have")
    main(Path(sys.argv[1]))
