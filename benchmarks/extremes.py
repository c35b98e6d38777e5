"""Sheets at the ends of what peers publish: near-rigid inclusions, plane strain, small strains of E and nu.

    python benchmarks/extremes.py [NAME ...]

Other finite elements than the project's compute each test (``benchmarks/strangers``). Cameras see a grid of points with
noise, a load cell has errors of its own. Sheets that were made and identified stay in ``.cache/extremes``.
"""

import sys
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from hypernode.pipeline.compiler import set_up_compiler

set_up_compiler(float64=True)

import numpy as np

from benchmarks.measured import grid_of, write_measurement
from benchmarks.strangers.design import SIDE, Sheet
from benchmarks.strangers.laws import stress
from benchmarks.strangers.solve import solve
from hypernode.config.methods import Constrained
from hypernode.config.presets import presets
from hypernode.data.measurement import mesh_of
from hypernode.evaluation.ratios import ratios
from hypernode.evaluation.spread import Samples
from hypernode.export.fields import stiffness
from hypernode.fem.gradient import deformation_gradient
from hypernode.material.files import material_of
from hypernode.stages import constrained
from hypernode.storage.netcdf import read

FOLDER = ROOT / ".cache" / "extremes"


@dataclass(frozen=True)
class Extreme:
    """One sheet and how it is identified.

    Attributes:
        sheet: the sheet and its test.
        method: preset whose equilibrium field is identified.
        noise: of a displacement, over the largest one.
        steps: load steps.
    """

    sheet: Sheet
    method: str
    noise: float
    steps: int


def _sheet(seed: int, **other) -> Sheet:
    known = {
        **{"shape": "discs", "load": "clamped_y", "across": 0.9, "points": 25, "seen": 1.0, "window": 0.0},
        **{"noise": 0.0, "step_pixels": 20.0, "force_scatter": 0.002, "force_gain": 0.003, "force_zero": 0.001},
    }
    return Sheet(seed=seed, **{**known, **other})


def _laws(**values) -> dict[str, np.ndarray]:
    return {name: np.array(each) for name, each in values.items()}


EXTREMES = {
    # Chains lock at a stretch of 5; between the discs the matrix is stretched by some 3.
    "rigid": Extreme(_sheet(3, kind="gent", laws=_laws(mu=[0.4, 80.0], J=[25.0, 25.0]), top=1.0), "field", 1e-3, 6),
    # nu of small strains: 0.42 and 0.3.
    "plane_strain": Extreme(
        _sheet(4, kind="plane_strain", laws=_laws(mu=[0.4, 1.0], lame=[2.1, 1.5]), top=0.2), "compressible", 1e-3, 3
    ),
    "linear": Extreme(
        _sheet(5, kind="linear", laws=_laws(mu=[0.4, 1.0], nu=[0.45, 0.25]), top=0.005), "compressible", 1e-3, 3
    ),
}


def identified(name: str) -> tuple[Path, float]:
    """(folder of a sheet with its measurement and field, seconds of the processor for the field; 0 if it was there)."""
    extreme, folder = EXTREMES[name], FOLDER / name
    measurement, field = folder / "measurement.nc", folder / "constrained.nc"
    if not measurement.exists():
        equilibria = solve(extreme.sheet, extreme.steps)
        noise = extreme.noise * extreme.sheet.top * SIDE
        write_measurement(extreme.sheet, equilibria, noise, measurement)
    began = time.process_time()
    if not field.exists():
        settings = Constrained.model_validate(_settings(extreme.method))
        constrained.run(settings, name, str(measurement), str(field), {"rule": "benchmark"})
    return folder, time.process_time() - began


def _settings(method: str) -> dict:
    if method == "compressible":
        return {**presets()["field"]["constrained"], **presets()["hypernode_compressible"]["constrained"]}
    return presets()[method]["constrained"]


def errors(name: str, folder: Path) -> dict[str, float]:
    """Relative errors of the stress in every phase at the deformation of the test, off interfaces."""
    sheet, mesh = EXTREMES[name].sheet, grid_of(EXTREMES[name].sheet)
    found, u = material_of(read(folder / "constrained.nc")), read(folder / "measurement.nc")["u_truth"].values
    F, X, weights = deformation_gradient(mesh, u), mesh.centres, sheet.weights(mesh.centres)
    true, P = stress(sheet.kind, sheet.laws, F, weights), np.asarray(found.stress(X, F), float)
    whole, phase, said = sheet.whole(X, sheet.step / 2), weights.argmax(axis=1), {}
    for k in range(sheet.phases):
        cells = whole & (phase == k)
        missed = ((P - true)[:, cells] ** 2).sum() / (true[:, cells] ** 2).sum()
        said[f"stress of phase {k + 1}"] = float(np.sqrt(missed))
    return said


def contrast(name: str, folder: Path) -> str:
    """What is said of the stiffness of the second phase over that of the first, and the true ratio of moduli."""
    extreme, found = EXTREMES[name], read(folder / "constrained.nc")
    stretch = 1.0 + 0.1 * min(1.0, extreme.sheet.top)
    samples = Samples.of(found, mesh_of(found).centres, "clamped_y", stretch)
    if samples is None or "material_label" not in found:
        return "no phases"
    label = found["material_label"].values
    order = np.argsort(np.argsort([np.median(samples.best[label == k]) for k in np.unique(label)]))
    told = ratios(order[label], samples.best, samples.values)
    mu = extreme.sheet.laws["mu"]
    return f"{', '.join(each.words for each in told) or 'one phase'}, moduli of shear are {mu[1] / mu[0]:g} to one"


def constants(name: str, folder: Path) -> str:
    """Mean E and nu of small strains in every phase off interfaces, and the true ones."""
    sheet = EXTREMES[name].sheet
    plane, X = ("strain" if sheet.kind == "plane_strain" else "stress"), grid_of(sheet).centres
    found = stiffness(material_of(read(folder / "constrained.nc")), X, 1.0 + sheet.top, plane)
    laws, phase, whole = sheet.laws, sheet.weights(X).argmax(axis=1), sheet.whole(X, sheet.step / 2)
    nu = laws["nu"] if "nu" in laws else laws["lame"] / (2.0 * (laws["lame"] + laws["mu"]))
    told = []
    for k, (true_nu, mu) in enumerate(zip(nu, laws["mu"], strict=True)):
        E, ratio = (found[name][whole & (phase == k)].mean() for name in ("young_y", "poisson_y"))
        told.append(f"E {E:.4g} of {2.0 * mu * (1.0 + true_nu):.4g}, nu {ratio:.4f} of {true_nu:.4f}")
    return "; ".join(told)


def main(names) -> None:
    """Make, identify and score."""
    for name in names or EXTREMES:
        folder, took = identified(name)
        told = ", ".join(f"{what} {value:.2%}" for what, value in errors(name, folder).items())
        answer = (contrast if EXTREMES[name].method == "field" else constants)(name, folder)
        print(f"{name}: {told}; {answer}; {took:.0f} s", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
