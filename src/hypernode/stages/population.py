"""One sheet of a population: from its geometry to its evaluation in one process, of which one file is kept."""

import json
import tempfile
from collections.abc import Callable
from pathlib import Path

from hypernode.config.model import Config
from hypernode.stages import baseline, constrained, evaluation, forward, gradient, measurement, true_material
from hypernode.storage.netcdf import read, units_of, write

#: Fields that are kept of an evaluation: where materials differ, how sure that is, and where they truly do.
FIELDS = ("X", "cells", "corners", "stretch", "trace_P", "trace_P_spread", "shape", "shape_true", "phase_found")
#: What is kept of its attributes.
ATTRIBUTES = ("thickness", "load", "shape_stretch", "summary", "verdict")
#: Attributes of a material, which its fields need to be read again.
MATERIAL = ("material_kind", "basis", "deformation_measures")


def run(config: Config, name: str, output: str, attributes: dict) -> None:
    """Compute, measure, identify and judge a synthetic sheet, and keep its material and what is judged of it.

    What stages leave to one another stays in a folder of this process for temporary files, and goes with it. The file
    has no parents: its settings, with the seed of its noise, are all that it was made from.

    Args:
        config: holds the case and its one method.

    Raises:
        ConvergenceError: the sheet has no equilibrium.
        IdentificationError: no equilibrium at the homogeneous start.
    """
    method = config.methods[config.cases[name].methods[0]]
    with tempfile.TemporaryDirectory() as folder:
        stages = ("truth", "forward", "measurement", "constrained", "gradient", "material", "evaluation")
        files = {stage: str(Path(folder) / f"{stage}.nc") for stage in stages}
        true_material.run(config, name, files["truth"], attributes)
        forward.run(config, name, files["truth"], files["forward"], attributes)
        measurement.run(config, name, files["forward"], files["measurement"], attributes)
        constrained.run(method.constrained, name, files["measurement"], files["constrained"], attributes)
        gradient.run(method.gradient, name, files["measurement"], files["gradient"], attributes, files["constrained"])
        files["field"] = files["gradient"]
        learnt = {key: files[key] for key in ("measurement", "field", "constrained")}
        baseline.run(method, name, learnt, files["material"], attributes)
        judged = {key: files[key] for key in ("truth", *learnt, "gradient", "material")}
        evaluation.run(config, name, judged, files["evaluation"], attributes)
        _keep(name, output, attributes, read(files["material"]), read(files["evaluation"]))


def _keep(name: str, output: str, attributes: dict, material, judged) -> None:
    variables = {key: judged[key].values for key in FIELDS if key in judged}
    variables |= {
        key: (material[key].dims, material[key].values) for key in material.variables if key.startswith("basis.")
    }
    if "deformation_seen" in material:
        variables["deformation_seen"] = material["deformation_seen"].values
    kept = {key: judged.attrs[key] for key in ATTRIBUTES} | {
        key: material.attrs[key] for key in MATERIAL if key in material.attrs
    }
    write(output, variables, f"sheet {name} of a population", {**attributes, **kept, "units": units_of(judged)})


def run_batch(config: Config, folder: str, attributes: dict, settings_of: Callable[[Config, str], dict]) -> None:
    """Every sheet of a job, one after the other: what one has compiled serves those after it.

    Args:
        config: holds the sheets and their method.
        folder: where a file and its record of each sheet go.
        attributes: what the job says of itself.
        settings_of: the part of the configuration that one sheet is made from, for its record.
    """
    for name, case in config.cases.items():
        own = {
            "run": {**attributes["run"], "case": name, "method": case.methods[0]},
            "settings": json.dumps(settings_of(config, name), sort_keys=True),
        }
        run(config, name, str(Path(folder) / f"{name}.nc"), {**attributes, **own})
