"""From the files of a run to advice on the next test of its sheet; nothing is written."""

import json
from pathlib import Path

import numpy as np

from hypernode.advice.candidates import LARGER, candidates
from hypernode.advice.further_test import PROBES, Advice, AdviceError, advise
from hypernode.config.methods import Constrained
from hypernode.identification.problem import FieldProblem
from hypernode.material.basis_file import basis_field
from hypernode.stages.as_identified import OtherUncertainty, problem_as_identified
from hypernode.storage.netcdf import read
from hypernode.storage.run_files import run_files
from hypernode.storage.schema import without_truth
from hypernode.verdict import Level, Verdict

#: Criteria whose failing says nothing against the equilibrium field: that much is open is why one asks, and what
#: networks miss of the field is theirs.
BESIDE_THE_FIELD = ("uncertainty", "networks")


def run(folder: Path, larger: float = LARGER, count: int = PROBES) -> Advice:
    """How much each further test of an identified sheet would narrow the stress that its test leaves open.

    Args:
        folder: results/CASE/METHOD of a finished run with an equilibrium field.
        larger: displacements of the larger tests over those of the present one.
        count: random vectors by which spreads are estimated.

    Raises:
        StorageError: the run has no evaluation, or a file of it is gone or damaged.
        AdviceError: the run does not explain its test, has no equilibrium field, or leaves nothing open.
    """
    folder = Path(folder)
    paths = run_files(folder)
    files = {key: read(paths[key]) for key in ("evaluation", "measurement", "constrained") if key in paths}
    _believed(str(folder), files)
    measurement, field = without_truth(files["measurement"]), files["constrained"]
    if "settings" not in field.attrs:
        raise AdviceError(f"{paths['constrained']}: does not say with which settings it was made: run it again")
    settings = Constrained.model_validate(json.loads(field.attrs["settings"])["constrained"])
    problem, measurement = _problem(str(paths["constrained"]), measurement, field, settings)
    _, stored = basis_field(field)
    params = np.empty((len(problem.mesh.cells), len(stored)))
    params[problem.refinement.subcells.T] = np.moveaxis(stored, 0, -1)
    guesses = [problem.refinement.interpolation @ u for u in field["u"].values]
    stretches = files["evaluation"]["stretch"].values
    tests, name = candidates(measurement, larger), f"{folder.resolve().parent.name}/{folder.resolve().name}"
    return advise(problem, params, guesses, measurement, settings, tests, stretches, name, count)


def _believed(name: str, files) -> None:
    """Nothing, where a run explains its test well enough for its field to be asked."""
    if "constrained" not in files:
        raise AdviceError(f"{name}: the method has no equilibrium field to ask: name a run of hypernode")
    if files["measurement"].attrs["forces"] == "assumed":
        raise AdviceError(
            f"{name}: no force was recorded, so that every stress is known up to one factor: the next test worth doing "
            "is the same one with its force"
        )
    verdict = Verdict.of(json.loads(files["evaluation"].attrs["verdict"]))
    failed = [c for c in verdict.ranked if c.level is Level.FAILED and c.name not in BESIDE_THE_FIELD]
    if failed:
        reasons = " ".join(each.sentence for each in failed)
        raise AdviceError(
            f"{name}: the verdict is fail, and a field that does not explain its own test tells nothing of another: "
            f"{reasons} See `hypernode verdict`"
        )


def _problem(name: str, measurement, field, settings: Constrained) -> tuple[FieldProblem, object]:
    """The problem whose answer a field is, and the measurement as the identification took it in the end."""
    basis, stored = basis_field(field)
    try:
        return problem_as_identified(measurement, field, settings, basis, round(stored.shape[1] ** 0.5))
    except OtherUncertainty as error:
        raise AdviceError(f"{name}: {error}") from None
