"""Stage 11: what was identified, in sheets of one phase each and in frames that were not used, against their tests."""

import json
from collections.abc import Mapping

import numpy as np

from hypernode.evaluation.references import PHASES, WHOLE, force_nrmse, reference_forces
from hypernode.material.files import parameter_field
from hypernode.progress import Progress
from hypernode.storage.netcdf import read, units_of, write


def run(name: str, references: Mapping[str, str], files: Mapping[str, str], output: str, attributes: dict) -> None:
    """Pull every reference sheet and compare its forces with those measured.

    Args:
        name: case of the identified specimen.
        references: phase -> case of the sheet that consists of it, ``whole`` -> case of other frames of the test.
        files: ``evaluation``, ``material``, and a measurement file by phase.
    """
    evaluation, material = read(files["evaluation"]), read(files["material"])
    node, params_at = parameter_field(material)
    phases = [phase for phase in (*PHASES, WHOLE) if phase in references]
    sheets = {phase: read(files[phase]) for phase in phases}
    measured = {phase: sheet["edge_force"].values for phase, sheet in sheets.items()}
    progress = Progress("references", name, sum(len(forces) for forces in measured.values()))
    found = {
        phase: reference_forces(phase, sheet, evaluation, node, params_at, progress) for phase, sheet in sheets.items()
    }
    write(
        output,
        {
            "load_case": np.repeat(np.arange(len(phases)), [len(measured[phase]) for phase in phases]),
            "stretch": np.concatenate([sheets[phase]["stretch"].values for phase in phases]),
            "edge_force": np.concatenate([measured[phase] for phase in phases]),
            "edge_force_identified": np.concatenate([found[phase] for phase in phases]),
        },
        f"other tests with what was identified in {name}",
        {
            **attributes,
            "units": units_of(material),
            "load_cases": [f"{phase}: {references[phase]}" for phase in phases],
            "load": json.loads(sheets[phases[0]].attrs["load_cases"])[0],
            "summary": {f"reference_nrmse_{phase}": force_nrmse(found[phase], measured[phase]) for phase in phases},
        },
        parents=files.values(),
    )
