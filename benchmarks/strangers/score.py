"""How far an identified sheet is from the true one, what it says of itself, and what it took."""

import json
from pathlib import Path

import numpy as np

from benchmarks.strangers.write import MODES
from hypernode.material.files import load_material, material_of, posterior_material
from hypernode.storage.netcdf import read
from hypernode.storage.run_files import run_files
from hypernode.verdict import Verdict

#: Component of the stress that stands for a mode, as weights of its entries.
_SHOWN = {
    "equibiaxial": np.eye(2),
    "along x": np.diag([1.0, 0.0]),
    "along y": np.diag([0.0, 1.0]),
    "shear": np.array([[0.0, 1.0], [0.0, 0.0]]),
}


def score(run: Path, truth_file: Path) -> dict:
    """Errors of networks and field, coverage, verdict and reasons.

    Args:
        run: results/CASE/METHOD of the identification.
        truth_file: of :func:`~benchmarks.strangers.write.write_truth`.

    Raises:
        StorageError: the run is not finished.
    """
    files = run_files(run)
    with np.load(truth_file) as stored:
        truth = dict(stored)
    found = errors("", load_material(files["material"]), truth)
    if "constrained" in files:
        constrained = read(files["constrained"])
        field = material_of(constrained)
        found |= errors("field ", field, truth) | _coverage(constrained, field, truth)
    verdict = Verdict.of(json.loads(read(files["evaluation"]).attrs["verdict"]))
    return found | {
        "verdict": str(verdict.overall),
        "because": ", ".join(f"{each.name} ({each.level})" for each in verdict.ranked if each.unmet),
    }


def errors(prefix: str, material, truth: dict) -> dict:
    """Relative errors of a material's stress, and the level of all stresses over the true one, by prefixed keys."""
    P, true, whole = np.asarray(material.stress(truth["X"], truth["F"]), float), truth["P"], truth["whole"]
    found = {
        "tested": relative_error(P, true, whole),
        "everywhere": relative_error(P, true, np.ones_like(whole)),
        "level": float((P * true)[:, whole].sum() / (true**2)[:, whole].sum()),
    }
    probed = whole & truth["inner"]
    P = np.asarray(material.stress(truth["X"], truth["mode_F"]), float)
    found |= {mode: relative_error(P[k], truth["mode_P"][k], probed) for k, mode in enumerate(MODES)}
    return {prefix + name: value for name, value in found.items()}


def relative_error(P, true, cells) -> float:
    """Root of the squared error over that of the true stress, P (state, cell, 2, 2), in some cells."""
    return float(np.sqrt(((P - true)[:, cells] ** 2).sum() / (true[:, cells] ** 2).sum()))


def _coverage(constrained, field, truth: dict) -> dict:
    """Share of cells off interfaces whose true stress is within two spreads, by mode; none without samples.

    The spread of a cell is the standard deviation of its posterior samples.
    """
    posterior = posterior_material(constrained)
    if posterior is None:
        return {}
    probed = truth["whole"] & truth["inner"]
    samples, cells = constrained.sizes["posterior_sample"], len(probed)
    # Samples are materials at cell centres, so that all cells are asked for.
    X = np.tile(truth["X"], (samples, 1))
    share = {}
    for k, (mode, shown) in enumerate(_SHOWN.items()):
        F, true = truth["mode_F"][k], (truth["mode_P"][k] * shown).sum(axis=(-2, -1))
        best = (np.asarray(field.stress(truth["X"], F), float) * shown).sum(axis=(-2, -1))
        drawn = (np.asarray(posterior.stress(X, np.tile(F, (1, samples, 1, 1))), float) * shown).sum(axis=(-2, -1))
        spread = drawn.reshape(len(F), samples, cells).std(axis=1, ddof=1)
        share[f"within two spreads, {mode}"] = float((np.abs(best - true) <= 2.0 * spread)[:, probed].mean())
    return share


def seconds_of_steps(results: Path) -> dict[str, float]:
    """Seconds of every rule of a workflow, by its name."""
    found: dict[str, float] = {}
    for file in sorted(results.glob("benchmarks/**/*.jsonl")):
        last = json.loads(file.read_text().splitlines()[-1])
        found[file.stem] = found.get(file.stem, 0.0) + float(last["s"])
    return found
