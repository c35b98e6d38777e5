"""Stage 1: equilibrium states of a synthetic sheet under its loads."""

from hypernode.config.model import Config
from hypernode.mechanics.loads import make_load
from hypernode.storage.netcdf import read, units_of, write
from hypernode.synthetic.forward import solve_loads


def run(config: Config, name: str, truth_file: str, output: str, attributes: dict) -> None:
    """Solve every load case of a synthetic sheet with JAX-FEM in float64.

    Raises:
        ConvergenceError: Newton's method fails; no file is written.
    """
    truth, case = read(truth_file), config.cases[name]
    loads = [make_load(config.loads[key].kind, config.loads[key].stretches) for key in case.loads]
    variables, thickness = solve_loads(truth, loads, name), case.thickness or 1.0
    variables |= {key: thickness * variables[key] for key in ("edge_force", "nodal_force")}
    variables |= {key: truth[key].values for key in ("X", "cells", "corners", "phase")}
    write(
        output,
        variables,
        f"finite-element solution of {name}",
        {**attributes, "units": units_of(truth), "load_cases": case.loads, "thickness": thickness},
        parents=[truth_file],
    )
