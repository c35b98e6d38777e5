"""From a test and the picture of its sheet's phases to their laws, in a file as an identification's."""

from pathlib import Path

from hypernode.config.methods import Constrained
from hypernode.data.measurement import mesh_of
from hypernode.evaluation.level_budget import level_budget, table
from hypernode.identification.interface_estimate import InterfaceEstimate
from hypernode.identification.known_shape import of_shape
from hypernode.identification.unseen_strips import stress_of
from hypernode.prediction.layout import one_phase
from hypernode.stages.constrained import write_field
from hypernode.stages.prediction import pictured
from hypernode.storage.netcdf import read, sha256
from hypernode.storage.schema import without_truth


def run(
    settings: Constrained, measurement_file: Path, picture: Path | None, flipped: bool, count: int, output: Path
) -> InterfaceEstimate:
    """Identify the laws of phases that are where a picture has them, and write OUTPUT/constrained.nc.

    Args:
        settings: the method's ``constrained`` section.
        picture: grey levels are phases, the darkest the softest; its first row is at the bottom where ``flipped``.
            None of a homogeneous sheet.
        count: of phases of the picture.
        output: a folder.

    Raises:
        PredictionError: the picture does not show that many phases.
        IdentificationError: the sheet finds no equilibrium.
        StorageError: the measurement is missing or damaged.
    """
    measurement, name = without_truth(read(measurement_file)), output.name
    shape = one_phase(mesh_of(measurement)) if picture is None else pictured(picture, flipped, count, measurement)
    found = of_shape(measurement, shape.distances, settings, name)
    output.mkdir(parents=True, exist_ok=True)
    budget = level_budget(measurement, stress_of(found, measurement))
    said = {
        "level_budget": [] if budget is None else table(budget),
        "rule": "hypernode phases",
        "raw_inputs": {} if picture is None else {str(picture): sha256(picture)},
    }
    write_field(found, measurement, settings, name, str(output / "constrained.nc"), said, [str(measurement_file)])
    return found
