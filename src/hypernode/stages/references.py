"""Stage 11: what was identified, in sheets of one phase each and in frames that were not used, against their tests."""

import json
from collections.abc import Mapping

import numpy as np

from hypernode.data.measurement import mesh_of
from hypernode.evaluation.references import PHASES, WHOLE, pulled_sheet, typical_places
from hypernode.material.files import parameter_field
from hypernode.progress import Progress
from hypernode.storage.netcdf import read, units_of, write


def run(name: str, references: Mapping[str, str], files: Mapping[str, str], output: str, attributes: dict) -> None:
    """Pull every reference sheet and compare its forces with those measured.

    The material of a phase is the mean of the identified ones at its typical places; the whole is the identified field.
    The error is the root mean square over the largest measured force of the sheet.

    Args:
        name: case of the identified specimen.
        references: phase -> case of the sheet that consists of it, ``whole`` -> case of other frames of the test.
        files: ``evaluation``, ``material``, and a measurement file by phase.
    """
    evaluation, material = read(files["evaluation"]), read(files["material"])
    node, params_at = parameter_field(material)
    measured, found, stretch, load_case = [], [], [], []
    phases = [phase for phase in (*PHASES, WHOLE) if phase in references]
    sheets = [read(files[phase]) for phase in phases]
    progress = Progress("references", name, sum(sheet.sizes["load_step"] for sheet in sheets))
    errors = {}
    for index, (phase, sheet) in enumerate(zip(phases, sheets, strict=True)):
        places = mesh_of(sheet).centres if phase == WHOLE else typical_places(evaluation, phase)
        node_params = np.asarray(params_at(places).T, float)
        forces = pulled_sheet(sheet, node, node_params[:, None] if phase == WHOLE else node_params, progress)
        true = sheet["edge_force"].values
        known = np.isfinite(true)
        errors[phase] = float(np.sqrt(np.mean((forces - true)[known] ** 2)) / np.abs(true[known]).max())
        measured.append(true)
        found.append(forces)
        stretch.append(sheet["stretch"].values)
        load_case.append(np.full(len(forces), index))
    write(
        output,
        {
            "load_case": np.concatenate(load_case),
            "stretch": np.concatenate(stretch),
            "edge_force": np.concatenate(measured),
            "edge_force_identified": np.concatenate(found),
        },
        f"other tests with what was identified in {name}",
        {
            **attributes,
            "units": units_of(material),
            "load_cases": [f"{phase}: {references[phase]}" for phase in phases],
            "load": json.loads(sheets[0].attrs["load_cases"])[0],
            "summary": {f"reference_nrmse_{phase}": error for phase, error in errors.items()},
        },
        parents=files.values(),
    )
