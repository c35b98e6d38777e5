"""From identified laws and the test, or the plan, of another sheet to its prediction, scored, in a file."""

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import xarray as xr

from hypernode.data.believed_window import BelievedWindow
from hypernode.data.measurement import mesh_of, plane_of
from hypernode.evaluation.level_budget import stored_beside_samples
from hypernode.fem.contour import ContourLines
from hypernode.mechanics.loads import Load
from hypernode.pictures.files import read_pictures
from hypernode.prediction.errors import PredictionError
from hypernode.prediction.laws import PhaseLaw, phase_laws
from hypernode.prediction.layout import Layout, of_identification, of_picture, one_phase
from hypernode.prediction.planned import planned_test
from hypernode.prediction.predict import Prediction, predict, problem_of
from hypernode.prediction.score import Score, score
from hypernode.storage.netcdf import read, sha256, units_of, write
from hypernode.storage.schema import without_truth
from hypernode.verdict import Level, Verdict

#: Cells along the longer side of a sheet that nobody has measured: as many as a usual grid of points has.
CELLS = 48


@dataclass(frozen=True)
class LawFrom:
    """Where laws are from: a run's folder or file, and one of its phases, from 1, the softest; None for all."""

    path: Path
    phase: int | None = None


@dataclass(frozen=True, kw_only=True)
class Target:
    """The sheet that is predicted: a measurement, or a size and a load; and where its phases are.

    Attributes:
        measurement: its file, or None.
        size, load: width, height and thickness [mm], and how it is pulled; of a sheet without a measurement.
        picture: of its phases, the darkest the softest; its first row is at the bottom where ``flipped``.
        lines: an identification of the same sheet, whose lines are used.
    """

    measurement: Path | None = None
    size: tuple[float, float, float] | None = None
    load: Load | None = None
    picture: Path | None = None
    flipped: bool = False
    lines: Path | None = None


def run(laws: Sequence[Sequence[LawFrom]], target: Target, output: Path) -> tuple[Prediction, Score]:
    """Predict a sheet and write NetCDF.

    Args:
        laws: specimens of each group; groups follow one another, and the phases of all specimens of a group are those
            that the others of it have.
        output: file that is written.

    Raises:
        PredictionError: laws, shape or load are missing or do not fit, with the way out.
        StorageError: a file is missing or damaged.
    """
    files = {path: read(path) for path in map(law_file, dict.fromkeys(each.path for g in laws for each in g))}
    pools = [pool for group in laws for pool in _pools(group, files)]
    measurement = _measurement(target, files.values())
    _same_units(measurement, files)
    _same_plane(measurement, files)
    problem = problem_of(measurement, pools)
    layout, parents = _layout(target, measurement, len(pools))
    found = predict(measurement, problem, pools, layout, output.stem)
    found = replace(found, remarks=[*found.remarks, *not_passed(files)])
    scored = score(measurement, found)
    parents = [*files, *parents, *([target.measurement] if target.measurement else [])]
    write(output, _variables(measurement, target, found), f"prediction {output.stem}", _said(
        measurement, target, pools, found, scored
    ), parents=parents)  # fmt: skip
    return found, scored


def not_passed(paths: Iterable[Path]) -> list[str]:
    """A sentence for every run that does not pass by its own verdict: its samples do not know what it misses."""
    said = []
    for path in paths:
        evaluation = path.parent / "evaluation.nc"
        if path.name != "constrained.nc" or not evaluation.is_file():
            continue
        verdict = Verdict.of(json.loads(read(evaluation).attrs["verdict"]))
        if verdict.overall.rank > Level.PASSED.rank:
            said.append(
                f"{path.parent}: its verdict is {verdict.label}: its laws may be wrong by more than their spread"
            )
    return said


def _same_units(measurement: xr.Dataset, files) -> None:
    """Nothing, where laws and sheet have the same units."""
    own = units_of(measurement)
    for path, file in files.items():
        if units_of(file) != own:
            raise PredictionError(
                f"{path}: has the units {units_of(file)}, and the sheet {own}: take laws and sheet from tests in the "
                "same units"
            )


def _same_plane(measurement: xr.Dataset, files) -> None:
    """Nothing, where laws and sheet are of thin sheets, or of bodies whose thickness stays."""
    own = plane_of(measurement)
    for path, file in files.items():
        if plane_of(file) != own:
            raise PredictionError(
                f"{path}: its law is that of plane {plane_of(file)}, and the sheet is in plane {own}: a law of one "
                "says nothing of the other; take laws and sheet of the same plane"
            )


def law_file(path: Path) -> Path:
    """The equilibrium field of a run, by its folder, or by another file of it.

    Raises:
        PredictionError: there is none.
    """
    folder = path if path.is_dir() else path.parent
    named = path if path.name.startswith("constrained") else folder / "constrained.nc"
    if not named.is_file():
        raise PredictionError(
            f"{path}: {named.name} is not there, which holds the laws of the phases: name the folder of a finished "
            "run, results/CASE/METHOD, of a method with an equilibrium field, such as hypernode"
        )
    return named


def _pools(group: Sequence[LawFrom], files) -> list[list[PhaseLaw]]:
    """Laws of every phase of a group of specimens."""
    by_specimen = []
    for each in group:
        path = law_file(each.path)
        level = _level_of(path, files[path])
        found = [replace(law, level=level) for law in phase_laws(files[path], str(path))]
        if each.phase is not None and not 1 <= each.phase <= len(found):
            raise PredictionError(f"{path}: has phases 1 to {len(found)}, from the softest, and no {each.phase}")
        by_specimen.append(found if each.phase is None else [found[each.phase - 1]])
    if len({len(found) for found in by_specimen}) > 1:
        counts = ", ".join(f"{each.path} {len(found)}" for each, found in zip(group, by_specimen, strict=True))
        raise PredictionError(f"specimens that are pooled have different numbers of phases ({counts}): name one, RUN:1")
    return [list(pool) for pool in zip(*by_specimen, strict=True)]


def _level_of(path: Path, file: xr.Dataset) -> float:
    """Relative standard uncertainty of a run's level by what its samples do not know, as it or its evaluation says."""
    said, evaluation = file.attrs, path.parent / "evaluation.nc"
    if "level_budget" not in said and path.name == "constrained.nc" and evaluation.is_file():
        said = read(evaluation).attrs
    return stored_beside_samples(json.loads(said.get("level_budget", "[]")))


def _measurement(target: Target, files) -> xr.Dataset:
    """The test, as seen through the window that the laws' own tests were found to be, where it states none."""
    if target.measurement is None:
        if target.size is None or target.load is None:
            raise PredictionError(
                "no sheet is named: name its measurement.nc, or give --size, --load and --stretches of one that has "
                "not been tested"
            )
        first = next(iter(files))
        planned = planned_test(target.size, target.load, CELLS)
        return planned.assign_attrs(units=first.attrs["units"], plane=plane_of(first))
    measurement = without_truth(read(target.measurement))
    if "u_measured" not in measurement:
        raise PredictionError(f"{target.measurement}: is no measurement: name results/CASE/measurement.nc")
    windows = [w for w in (BelievedWindow.read(file.attrs) for file in files) if w is not None]
    if measurement.attrs["correlation_window"] > 0 or not windows:
        return measurement
    sides, errors = np.array([(w.side, w.error) for w in windows]).T
    return replace(windows[0], side=float(sides.mean()), error=float(errors.mean())).of(measurement)


def _layout(target: Target, measurement: xr.Dataset, count: int) -> tuple[Layout, list[Path]]:
    """(where phases are, the result file that says so)."""
    mesh = mesh_of(measurement)
    if target.lines is not None:
        path = law_file(target.lines)
        return of_identification(read(path), str(path), count, mesh), [path]
    if target.picture is not None:
        return pictured(target.picture, target.flipped, count, measurement), []
    if count > 1:
        raise PredictionError(
            f"there are laws of {count} phases, and nothing says which is where: give a picture (--shape FILE), "
            "another identification of the sheet (--lines RUN), or one law (RUN:1)"
        )
    return one_phase(mesh), []


def pictured(picture: Path, flipped: bool, count: int, measurement: xr.Dataset) -> Layout:
    """Where the phases that a picture shows are on a measured sheet.

    Args:
        picture: its file; the first row is at the bottom of the sheet where ``flipped``.
        count: of phases.
        measurement: opened.

    Raises:
        PredictionError: the picture does not show that many phases.
        PictureError: it cannot be read.
    """
    grey = read_pictures([picture])[0]
    corners = json.loads(measurement.attrs.get("field_corners", "null")) or measurement["corners"].values
    grid = ContourLines(mesh_of(measurement))
    return of_picture(grey[::-1] if flipped else grey, count, grid, np.array(corners))


def _variables(measurement: xr.Dataset, target: Target, found: Prediction) -> dict:
    kept = ("X", "cells", "corners", "load_case", "stretch")
    tested = ("u_measured", "edge_force") if target.measurement else ()
    return {name: measurement[name].values for name in (*kept, *tested)} | {
        "u": found.u,
        "u_spread": found.u_spread,
        "edge_force_predicted": found.force,
        "edge_force_spread": found.force_spread,
        "material_label": found.field.labels().astype(np.int16),
    }


def _said(measurement: xr.Dataset, target: Target, pools, found: Prediction, scored: Score) -> dict:
    """Attributes of the file."""
    return {
        "rule": "hypernode predict",
        "units": units_of(measurement),
        "thickness": float(measurement.attrs["thickness"]),
        "forces": measurement.attrs["forces"],
        "laws": [[f"{law.source}, material {law.label}" for law in pool] for pool in pools],
        "raw_inputs": {str(target.picture): sha256(target.picture)} if target.picture else {},
        "remarks": found.remarks,
        "score": scored.stored(),
    }
