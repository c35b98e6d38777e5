"""What the constrained field of one sheet takes: processor time by what it is spent on, memory, and counted work.

Runs in a process of its own for every measurement, so that imports, compilation and the peak of memory are its own, on
one core. It calls the stages of whatever version of the package is on its path, so that two versions can be compared.

Usage: python benchmarks/cost_of_one.py '{"cells": 25, "steps": 4, "terms": 4, "sheets": 1}'
"""

import json
import resource
import sys
import tempfile
import time
from pathlib import Path

from hypernode.pipeline.cores import claimed_cores

#: Terms beside the stiffness, in the order in which they are added.
TERMS = ("I1_squared", "I2", "fibre", "stiffening")
LARGEST_STRETCH = 1.2
#: Number of terms -> inclusion and matrix that take them all.
MATERIALS = {
    1: tuple({"model": "yeoh", "C10": C10, "C20": 0.2 * C10, "C30": 0.0} for C10 in (0.5, 0.2)),
    2: (
        {"model": "yeoh", "C10": 0.5, "C20": 0.1, "C30": 0.0},
        {"model": "mooney_rivlin", "C10": 0.15, "C01": 0.05},
    ),
    4: (
        {"model": "goh", "C10": 0.5, "k1": 0.1, "k2": 0.2, "kappa": 0.1, "fibre_angle": 20.0},
        {"model": "goh", "C10": 0.2, "k1": 0.02, "k2": 0.04, "kappa": 0.0, "fibre_angle": -35.0},
    ),
}


def configuration(cells: int, steps: int, terms: int, sheets: int, noise: float) -> dict:
    """An X of one material in another under equibiaxial stretch, each sheet with errors of its own."""
    stretches = [1.0 + (LARGEST_STRETCH - 1.0) * (step + 1) / steps for step in range(steps)]
    case = {"geometry": "X", "inclusion": "stiff", "matrix": "soft", "loads": ["load"], "methods": ["alone"]}
    case |= {"cells": [cells, cells]}
    names = {f"sheet_{k}": case | ({"noise": f"seed_{k}"} if noise else {}) for k in range(sheets)}
    terms_alone = {"terms": list(TERMS[:terms]), "isotropic_terms": [], "further_terms": []}
    return {
        "geometries": {"X": {"shape": "glyph", "text": "X", "height": 0.6}},
        "materials": dict(zip(("stiff", "soft"), MATERIALS[terms], strict=True)),
        "loads": {"load": {"kind": "equibiaxial", "stretches": stretches}},
        "noise": {f"seed_{k}": {"sigma": noise, "seed": k} for k in range(sheets)} if noise else {},
        "methods": {"alone": {"baseline": "constrained", "constrained": terms_alone}},
        "cases": names,
    }


class Clock:
    """Time by what it is spent on: what is entered last counts, and what was entered before it stands still."""

    def __init__(self):
        self.spent: dict[str, float] = {}
        self._entered, self._since = ["other"], time.perf_counter()

    def turn(self) -> None:
        """Count what has passed for what was entered last."""
        now = time.perf_counter()
        last = self._entered[-1]
        self.spent[last] = self.spent.get(last, 0.0) + now - self._since
        self._since = now

    def timed(self, function, what: str, counts: dict, counted: str = "", amount=lambda *given: 1):
        """``function`` whose time counts as ``what``, and whose calls are counted."""

        def wrapped(*given, **named):
            if counted:
                counts[counted] = counts.get(counted, 0) + amount(*given)
            self.turn()
            self._entered.append(what)
            try:
                return function(*given, **named)
            finally:
                self.turn()
                self._entered.pop()

        return wrapped


def watch(clock: Clock, counts: dict) -> list[tuple[float, float]]:
    """Time and count what a constrained field is made of; returns where spans of compilation are noted, [s]."""
    import jax
    import numpy as np

    from hypernode.fem import factors, solver
    from hypernode.identification import deflated_cg, sensitivities

    class Counted:
        """Factors whose back-substitutions are counted, a column each."""

        def __init__(self, made):
            self._solve = made.solve

        def solve(self, b):
            counts["solves"] = counts.get("solves", 0) + (1 if np.ndim(b) == 1 else np.shape(b)[1])
            return self._solve(b)

    factorise = factors.factorise
    counting = clock.timed(lambda *given: Counted(factorise(*given)), "factorisation", counts, "factorisations")
    for module in list(sys.modules.values()):
        if getattr(module, "factorise", None) is factorise:
            module.factorise = counting
    cg, step, sheet = deflated_cg.DeflatedCG, sensitivities.StepJacobian, solver.EquilibriumSolver
    cg.solve = clock.timed(cg.solve, "cg", counts, "cg_runs")
    step.curvature = clock.timed(step.curvature, "cg", counts, "cg_products")
    sheet.tangent = clock.timed(sheet.tangent, "assembly", counts, "tangents")
    sheet.internal_force = clock.timed(sheet.internal_force, "assembly", counts, "evaluations")

    spans: list[tuple[float, float]] = []

    def noted(event: str, seconds: float, **_):
        if event.startswith("/jax/core/compile/"):
            spans.append((time.perf_counter() - seconds, time.perf_counter()))
            # What compiles stands within what asked for it.
            clock.turn()
            last = clock._entered[-1]
            fresh = seconds - covered(spans[:-1], *spans[-1])
            clock.spent[last] -= fresh
            clock.spent["compile"] = clock.spent.get("compile", 0.0) + fresh

    jax.monitoring.register_event_duration_secs_listener(noted)
    return spans


def covered(spans, begin: float, end: float) -> float:
    """How much of a span lies in others, which do not overlap but where one holds another."""
    inside = [(a, b) for a, b in spans if a >= begin - 1e-6 and b <= end + 1e-6]
    outermost = [one for one in inside if not any(a <= one[0] and one[1] <= b for a, b in inside if (a, b) != one)]
    return sum(b - a for a, b in outermost)


def measure(cells: int, steps: int, terms: int, sheets: int, noise: float = 0.0) -> dict:
    """One measurement."""
    with claimed_cores(1):
        return _measured(cells, steps, terms, sheets, noise)


def _measured(cells: int, steps: int, terms: int, sheets: int, noise: float) -> dict:
    begun = time.process_time()
    from hypernode.config.loading import check_config
    from hypernode.pipeline.compiler import set_up_compiler

    set_up_compiler(float64=True)
    from hypernode.stages import constrained, forward, measurement, true_material
    from hypernode.storage.netcdf import read

    imported = time.process_time() - begun
    config = check_config(configuration(cells, steps, terms, sheets, noise))
    counts: dict = {}
    clock = Clock()
    watch(clock, counts)
    with tempfile.TemporaryDirectory() as folder:
        attributes = {"rule": "benchmark"}
        files = {}
        for name in config.cases:
            files[name] = [str(Path(folder) / f"{name}_{stage}.nc") for stage in ("truth", "forward", "measured", "u")]
            truth, solved, measured, _ = files[name]
            true_material.run(config, name, truth, attributes)
            forward.run(config, name, truth, solved, attributes)
            measurement.run(config, name, solved, measured, attributes)
        counts.clear()
        clock.turn()
        clock.spent.clear()
        wall, begun = time.perf_counter(), time.process_time()
        for name in config.cases:
            constrained.run(config.methods["alone"].constrained, name, files[name][2], files[name][3], attributes)
        clock.turn()
        spent, wall = time.process_time() - begun, time.perf_counter() - wall
        ended = read(files[name][3])
    # Parts were timed by the clock on the wall, which others on the machine stretch: their shares are kept.
    parts = {f"{what}_s": seconds * spent / wall for what, seconds in clock.spent.items()}
    return {
        "import_s": imported,
        "total_s": imported + spent,
        "run_s": spent - parts.get("compile_s", 0.0),
        **parts,
        "memory_MB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        **counts,
        "ending": ended.attrs["ending"],
    }


if __name__ == "__main__":
    print(json.dumps(measure(**json.loads(sys.argv[1]))))
