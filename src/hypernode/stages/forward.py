"""Stage 1: equilibrium states of a synthetic sheet under its loads."""

from hypernode.config.model import Config
from hypernode.mechanics.loads import make_load
from hypernode.storage.netcdf import SYNTHETIC_UNITS, read, write
from hypernode.synthetic.forward import solve_loads


def run(config: Config, name: str, truth_file: str, output: str, attributes: dict) -> None:
    """Solve every load case of a synthetic sheet with JAX-FEM in float64.

    Raises:
        ConvergenceError: Newton's method fails; no file is written.
    """
    truth, case = read(truth_file), config.cases[name]
    loads = [make_load(config.loads[key].kind, config.loads[key].stretches) for key in case.loads]
    variables = solve_loads(truth, loads, name)
    variables |= {key: truth[key].values for key in ("X", "cells", "corners", "phase")}
    write(
        output,
        variables,
        f"finite-element solution of {name}",
        {**attributes, "units": SYNTHETIC_UNITS, "load_cases": case.loads, "thickness": 1.0},
        parents=[truth_file],
    )
