"""One sheet of a study of the level, from its design to its score, in a process of its own."""

import json
import shutil
import sys
from pathlib import Path

import numpy as np
import yaml

from benchmarks.level.designs import STUDIES
from benchmarks.strangers.design import Sheet
from benchmarks.strangers.laws import stress
from benchmarks.strangers.one import Failed, identified, reason, version
from benchmarks.strangers.score import errors, relative_error
from benchmarks.strangers.solve import solve
from benchmarks.strangers.write import write_test, write_truth
from hypernode.material.files import material_of
from hypernode.mechanics.modes import MODES, mode_gradients
from hypernode.pipeline.compiler import set_up_compiler
from hypernode.storage.netcdf import read
from hypernode.verdict import Level, Verdict

METHOD = "field"
#: Stated standard uncertainties within which the level should be.
SPREADS = 2.0


def main(study: str, name: str, folder: Path, changed: dict) -> None:
    """Make the test, identify it, and write ``score.json``.

    Raises:
        Failed: the workflow ended without an evaluation.
    """
    set_up_compiler(float64=True)
    sheet, brought, truth = STUDIES[study]()[name], folder / "brought", folder / "truth.npz"
    if not (folder / "made").exists():
        shutil.rmtree(folder, ignore_errors=True)
        equilibria = solve(sheet)
        write_test(sheet, equilibria, brought)
        write_truth(sheet, equilibria, truth)
        (folder / "made").touch()
    config = yaml.safe_load((brought / "sheet.yaml").read_text())
    # An import asks what a force at the first picture is.
    config["specimens"]["sheet"] |= ({"force_offset": 0.0} if sheet.preload else {}) | changed
    config["cases"] = {"sheet": {"specimen": "sheet", "methods": [METHOD]}}
    (brought / "study.yaml").write_text(yaml.safe_dump(config, sort_keys=False))
    run = Path("results") / "sheet" / METHOD
    # What was identified with other keys is no answer to these.
    (brought / run / "evaluation.nc").unlink(missing_ok=True)
    _, took = identified(brought, "study.yaml", str(run / "evaluation.nc"))
    if not (brought / run / "evaluation.nc").is_file():
        raise Failed(reason(brought / "workflow.log"))
    row = {"name": name, "code": version(), "changed": changed, **scored(brought / run, truth, sheet), **took}
    (folder / "score.json").write_text(json.dumps(row, indent=1) + "\n")


def scored(run: Path, truth_file: Path, sheet: Sheet) -> dict:
    """Level over the true one, what is stated of it, and how the run is judged.

    Args:
        run: results/CASE/METHOD.
        truth_file: of :func:`~benchmarks.strangers.write.write_truth`.
        sheet: whose test it is.
    """
    with np.load(truth_file) as stored:
        truth = dict(stored)
    constrained, evaluation = read(run / "constrained.nc"), read(run / "evaluation.nc")
    material = material_of(constrained)
    found = errors("", material, truth) | _modes(material, truth, sheet, json.loads(evaluation.attrs["doubt"]))
    budget = json.loads(evaluation.attrs["level_budget"])
    parts = {row["input"]: row["level"] for row in budget}
    verdict = Verdict.of(json.loads(evaluation.attrs["verdict"]))
    refuted = next(each for each in verdict.criteria if each.name == "refuted")
    return found | {
        "stated": parts["level"],
        "parts": parts,
        "within": bool(abs(found["level"] - 1.0) <= SPREADS * parts["level"]),
        "refuted": float(refuted.value or 0.0),
        "law_refuted": refuted.unmet,
        "volume": next((each.sentence for each in verdict.criteria if each.name == "volume"), ""),
        "told": verdict.overall is not Level.PASSED,
        "verdict": str(verdict.overall),
        "because": ", ".join(f"{each.name} ({each.level})" for each in verdict.ranked if each.unmet),
        "suspects": [each.name for each in verdict.suspects],
    }


def _modes(material, truth: dict, sheet: Sheet, doubt: list[dict]) -> dict:
    """Of each mode at the stretch of the test: the error of its stress off interfaces, and the doubt that is stated."""
    X, probed = truth["X"], truth["whole"] & truth["inner"]
    weights = sheet.weights(X + sheet.kept.start * sheet.step)
    found = {}
    for each in doubt:
        if each["reach"] != 1.0 or each["mode"] not in MODES:
            continue
        F = np.tile(mode_gradients([each["stretch"]])[MODES.index(each["mode"])], (1, len(X), 1, 1))
        true, P = stress(sheet.kind, sheet.laws_at(0.0), F, weights), np.asarray(material.stress(X, F), float)
        found[each["mode"]] = [relative_error(P, true, probed), each["total"]]
    return {"modes": found}


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], Path(sys.argv[3]), json.loads(sys.argv[4]))
