"""The example of JAX-FEM runs on the file of a run."""

import importlib.util
from pathlib import Path

import numpy as np

from tests.export.runs import MU, write_run

EXAMPLE = Path(__file__).resolve().parents[2] / "docs/examples" / "jax_fem_sheet.py"


def test_the_example_prints_the_forces_of_a_sheet_between_those_of_its_phases(tmp_path, capsys):
    spec = importlib.util.spec_from_file_location("jax_fem_sheet", EXAMPLE)
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    example.main(write_run(tmp_path) / "material.nc", 1.05)
    forces = [float(line.rsplit(" ", 1)[1]) for line in capsys.readouterr().out.splitlines()]
    assert len(forces) == 5 and (np.diff(forces) > 0.0).all()
    # Stiffer than its softer phase with free sides, and softer than its stiffer one with all sides held.
    assert MU[0] * (1.05 - 1.05**-2) < forces[-1] < MU[1] * (1.05 - 1.05**-3)
