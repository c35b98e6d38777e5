"""Level of the elastic records by their forces alone: what is imported over what the sheet carries, with no search.

A field that explains the forces of its load steps has their level. So the mean of imported over true forces at the
same elongation stands for it, by the weights of the identification. The spread is that of pairing, relaxation, preload
and camera; load cell and section are the same for all.

Usage: python -m benchmarks.level.records [--to .cache/records]
"""

import argparse
import contextlib
import io
import os
from pathlib import Path

import numpy as np
import yaml
from scipy.interpolate import CubicSpline

from benchmarks.level.designs import STUDIES
from benchmarks.level.one import SPREADS
from benchmarks.strangers.design import THICKNESS, Sheet
from benchmarks.strangers.solve import Equilibria, solve
from benchmarks.strangers.write import FRAMES, write_test
from hypernode.config.specimens import Specimen
from hypernode.dic.errors import DicError
from hypernode.dic.specimen import import_specimen
from hypernode.pipeline.compiler import set_up_compiler

#: Largest spread of a stiffness that is known well.
NARROW = 0.04
#: Uncertainty of a force that a configuration states where it says nothing.
STATED = 0.01


def imported(sheet: Sheet, equilibria: Equilibria, folder: Path):
    """(level over the true one, its spread, sentences on the clock) of a sheet's test, once its files are written.

    Raises:
        DicError: the import refuses or asks.
    """
    write_test(sheet, equilibria, folder)
    given = yaml.safe_load((folder / "sheet.yaml").read_text())["specimens"]["sheet"]
    given |= {"force_offset": 0.0} if sheet.preload else {}
    with contextlib.chdir(folder), contextlib.redirect_stderr(io.StringIO()):
        case = import_specimen(Specimen(**given)).cases[0]
    true = CubicSpline(np.r_[0.0, equilibria.amount], np.r_[0.0, THICKNESS * equilibria.force[:, 1]])
    # The pictures show the elongation since the first one.
    shown = (case.numbers - 1) / (FRAMES - 1) * (1.0 - sheet.preload / sheet.top)
    level = case.force[1, 1] / case.relaxation.at(case.time) / true(shown)
    opened = case.relaxation.open_at(case.time)
    weights = 1.0 / (STATED**2 + case.pairing**2 + opened**2)
    weights /= weights.sum()
    camera = given.get("camera_distance_uncertainty", Specimen(**given).camera_distance_uncertainty)
    strain = weights @ (1.0 / (case.stretch - 1.0))
    parts = [weights @ case.pairing, np.sqrt(weights @ opened**2), case.preload, camera * strain]
    return float(weights @ level), float(np.linalg.norm(parts)), case.findings


def main() -> None:
    """A line for each record, and how many are known."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--to", type=Path, default=Path(".cache/records"), help="folder of the tests")
    to = parser.parse_args().to.resolve()
    set_up_compiler(float64=True)
    solved, within, narrow, sheets = {}, 0, 0, STUDIES["records"]()
    for name, sheet in sheets.items():
        if sheet.kind not in solved:
            solved[sheet.kind] = solve(sheet)
        os.makedirs(to / name, exist_ok=True)
        try:
            level, spread, findings = imported(sheet, solved[sheet.kind], to / name)
        except DicError as error:
            print(f"{name:28} refused: {error}", flush=True)
            continue
        known = abs(level - 1.0) <= SPREADS * spread
        within, narrow = within + known, narrow + (spread <= NARROW)
        taken = next((each.split(";")[0] for each in findings if "forces are read" in each), "")
        print(f"{name:28} level {level:.3f} +- {spread:.3f} {'within' if known else 'BEYOND'} {taken}", flush=True)
    print(f"{len(sheets)} records: within {SPREADS:g} spreads {within}, spread <= {NARROW:.0%} {narrow}.")


if __name__ == "__main__":
    main()
