"""From a file of the challenge to the label of every point, by the project's own import and identification."""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from hypernode.challenge.classes import PairOfMaterials, in_two, nearest_pair
from hypernode.challenge.files import SIDE, ChallengeTest, challenge_test
from hypernode.challenge.scoring import dice, turned
from hypernode.config.methods import Constrained
from hypernode.config.presets import presets
from hypernode.config.specimens import Specimen
from hypernode.data.measurement import mesh_of
from hypernode.dic.array_files import arrays_in
from hypernode.dic.specimen import import_specimen
from hypernode.identification.partition import without_small
from hypernode.material.basis_file import basis_field
from hypernode.stages import constrained
from hypernode.stages.imported_sheet import attributes_of, variables_of
from hypernode.storage.netcdf import EXPERIMENT_UNITS, read, write

#: Thickness of every sheet of the challenge [mm], and the method that identifies it.
THICKNESS, METHOD = 2.0, "hypernode"
#: Stretch along the pull under which stiffnesses are compared, as of an incompressible strip: a pull tells
#: little of what an equal stretch both ways would meet.
STRETCH = 1.05


@dataclass(frozen=True, kw_only=True)
class Labelled:
    """What was found of a test.

    Attributes:
        test: the test.
        stiffer: 1 where a point is of the stiffer phase, else 0 (nx, ny).
        stress: what stands for the stiffness of the softer and of the stiffer phase [MPa].
        pair: the materials that they are; None where no classes are known.
        predicted_label: of every point (nx, ny); 0 and 1 where no classes are known.
        score: the challenge's, where the file has a label; without classes that of the shape alone.
        remarks: sentences on the file and on what was found.
    """

    test: ChallengeTest
    stiffer: Int[np.ndarray, "nx ny"]
    stress: tuple[float, float]
    pair: PairOfMaterials | None
    predicted_label: Int[np.ndarray, "nx ny"]
    score: float | None
    remarks: list[str]


def run(path: Path, pairs: Sequence[PairOfMaterials] = ()) -> Labelled:
    """Label a test.

    Args:
        path: npz file of the challenge.
        pairs: materials that occur together.

    Raises:
        ChallengeError, DicError: the file is no test of the challenge or cannot be used.
    """
    test = challenge_test(arrays_in(path), str(path))
    remarks = list(test.remarks)
    with tempfile.TemporaryDirectory() as folder:
        measurement = _imported(test, Path(folder))
        stiffer, stress = _phases(test, measurement, Path(folder), path.stem, remarks)
    pair = nearest_pair(pairs, stress) if pairs else None
    predicted = stiffer if pair is None else np.where(stiffer == 1, pair.stiff, pair.soft)
    score = None
    if test.label is not None:
        named = predicted if pair is not None else named_as(test.label, stiffer)
        score = dice(test.label, named)
        better = turned(test.label, named_as(test.label, stiffer), test.down)
        if better:
            remarks.append(f"the label fits what the sheet does better {better}: it may lie otherwise than the sheet")
    return Labelled(
        test=test, stiffer=stiffer, stress=stress, pair=pair, predicted_label=predicted, score=score, remarks=remarks
    )


def named_as(label, stiffer):
    """Phases named after the two classes of a label, whichever way fits better."""
    classes = np.unique(label)[[0, -1]]
    both = [np.where(stiffer == 1, classes[1 - k], classes[k]) for k in (0, 1)]
    return max(both, key=lambda each: dice(label, each))


def _imported(test: ChallengeTest, folder: Path) -> Path:
    """The measurement file of a test, by the project's importer."""
    brought = folder / "test"
    brought.mkdir()
    held = {"DIC_X": test.X, "DIC_disp": test.u, "instron_disp": test.crosshead, "instron_force": test.force}
    np.savez(brought / "test.npz", **held)
    specimen = Specimen.model_validate(
        {
            **{"folder": str(brought), "format": "arrays", "load": "clamped_y", "crosshead": False},
            **{"width": SIDE, "height": SIDE, "thickness": THICKNESS, "force_offset": float(test.force[0])},
        }
    )
    sheet, corner, output = import_specimen(specimen), np.zeros(2), folder / "measurement.nc"
    said = attributes_of(specimen, sheet, corner) | {"units": EXPERIMENT_UNITS, "load_cases": ["clamped_y"]}
    write(output, variables_of(sheet, corner), "test of the challenge", {"rule": "hypernode challenge", **said})
    return output


def _phases(test: ChallengeTest, measurement: Path, folder: Path, name: str, remarks: list[str]):
    """(1 for every point of the stiffer phase, else 0; stiffness of both)."""
    settings = Constrained.model_validate(presets()[METHOD]["constrained"]).model_copy(update={"posterior_samples": 0})
    found = _identified(settings, name, measurement, folder / "field.nc")
    if len(np.unique(_log_stiffness(found))) == 1:
        remarks.append("one material explains the test: what differs within its noise is cut in two")
        by_cell = settings.model_copy(update={"terms": [], "further_terms": [], "layers": False})
        found = _identified(by_cell, name, measurement, folder / "cells.nc")
    log_stiffness, mesh = _log_stiffness(found), mesh_of(found)
    stiffer, stress = in_two(log_stiffness)
    at_nodes = _at_nodes(found, without_small(mesh, stiffer))
    # The measured field begins at its corner; outermost points lie beyond the grid, and are as those next to them.
    place = test.X.reshape(-1, 2) - test.X.reshape(-1, 2).min(axis=0)
    return at_nodes[cKDTree(mesh.nodes).query(place)[1]].reshape(test.X.shape[:2]), stress


def _identified(settings: Constrained, name: str, measurement: Path, output: Path):
    constrained.run(settings, name, str(measurement), str(output), {"rule": "hypernode challenge"})
    return read(output)


def _log_stiffness(found) -> Float[np.ndarray, " cell"]:
    """Logarithm of the size of the stress of every cell at :data:`STRETCH`."""
    basis, params = basis_field(found)
    F = np.diag([STRETCH**-0.5, STRETCH])[:, :, None, None] * np.ones(params.shape[1:])
    return np.log(np.linalg.norm(np.asarray(basis.stress(F, params)), axis=(0, 1)).mean(axis=0))


def _at_nodes(found, stiffer: Int[np.ndarray, " cell"]) -> Int[np.ndarray, " node"]:
    """The phase of every node: that of its material where lines are known, else of most of the cells around it."""
    cells, count = found["cells"].values, found.sizes["node"]
    if "interface_distance" in found:
        labels = found["material_label"].values
        of_material = [
            int(np.median(stiffer[labels == k])) if (labels == k).any() else 0 for k in range(labels.max() + 1)
        ]
        material = np.zeros(count, int)
        for k, distance in enumerate(found["interface_distance"].values, start=1):
            material[distance > 0] = k
        return np.array([*of_material, *[0] * (material.max() + 1 - len(of_material))])[material]
    sums = np.bincount(cells.ravel(), np.repeat(stiffer, 4), count) / np.bincount(cells.ravel(), minlength=count)
    return (sums > 0.5).astype(int)
