"""Stage 2 of a photographed sheet: its correlated points and the load cells become a measurement file."""

import json
from pathlib import Path
from typing import get_args

import numpy as np
import xarray as xr
from jaxtyping import Float

from hypernode.config.model import Config
from hypernode.config.specimen_tests import SpecimenLoad
from hypernode.config.specimens import Specimen
from hypernode.config.synthetic import Noise
from hypernode.data.information import NAMES
from hypernode.data.measurement import mesh_of
from hypernode.dic.correlated import series_of, whole_subsets
from hypernode.dic.load_case import LoadCase, load_case_of
from hypernode.dic.series import Series
from hypernode.dic.specimen import ImportedSpecimen, specimen_of
from hypernode.fem.gradient import deformation_gradient
from hypernode.fem.interpolation import NodalField
from hypernode.fem.mesh import EDGE_NAMES
from hypernode.mechanics.loads import RESULTANTS
from hypernode.pictures.correlation import Correlated
from hypernode.pictures.photograph import followed
from hypernode.pictures.window import window_of
from hypernode.stages.imported_sheet import attributes_of, variables_of
from hypernode.storage.netcdf import read, units_of, write
from hypernode.synthetic.errors import with_force_errors

#: Edges with the lower and the larger coordinate, by the axis of their normal.
_OPPOSITE = (("left", "right"), ("bottom", "top"))


def run(config: Config, name: str, forward_file: str, correlated_file: str, output: str, attributes: dict) -> None:
    """Import a photographed sheet as a real one, of which the grid is cut out: the truth is added for the evaluation.

    Raises:
        DicError: the points are too few, or too many of them were lost.
    """
    forward, correlated, case = read(forward_file), read(correlated_file), config.cases[name]
    noise = config.noise[case.noise] if case.noise else Noise()
    settings, pixel = case.camera.correlated, float(correlated.attrs["mm_per_pixel"])
    series, corner = _series(correlated, Path(correlated_file), forward, settings.footprint * pixel)
    side, kernel = window_of(settings)
    specimen = _specimen(name, forward, noise, side * pixel, kernel)
    loads = [config.loads[key].kind for key in case.loads]
    sheet = specimen_of(specimen, _load_cases(specimen, loads, series, forward, noise))
    variables = variables_of(sheet, corner)
    variables |= _noise(correlated, variables, pixel)
    variables |= {key: correlated[key].values for key in NAMES if key in correlated}
    variables |= {key: forward[key].values for key in ("load_case", "stretch")} | _truth(forward, sheet, corner)
    write(
        output,
        variables,
        f"measurement of {name} from its pictures",
        {
            **attributes,
            **attributes_of(specimen, sheet, corner),
            "units": units_of(forward),
            "load_cases": forward.attrs["load_cases"],
        },
        parents=[forward_file, correlated_file],
    )


def _noise(correlated: xr.Dataset, found: dict[str, np.ndarray], pixel: float) -> dict[str, np.ndarray]:
    """What is said of the noise, where points have told ``found``.

    What subsets that overlap share is not seen between neighbours, and is not below what grey noise alone makes. Finite
    elements know their own.
    """
    said = {key: np.array(json.loads(correlated.attrs[key])) * pixel for key in correlated.attrs if "_noise" in key}
    if "least_noise" in said:
        return {key: np.maximum(found[key], said["least_noise"]) for key in ("noise_scatter", "noise_level")}
    return {f"noise_{key}": said[f"{key}_noise"] for key in ("scatter", "level")}


def _series(correlated: xr.Dataset, path: Path, forward: xr.Dataset, subset: float):
    """(frames of the points whose subsets are on the sheet, corner of their grid)."""
    upward = np.array([1.0, -1.0]) * float(correlated.attrs["mm_per_pixel"])
    origin = np.array([correlated.attrs["origin_column"], correlated.attrs["origin_row"]])
    points = Correlated.from_dataset(correlated)
    position = (np.stack([points.column, points.row], axis=1) - origin) * upward
    lower, upper = forward["corners"].values
    kept = whole_subsets(position - lower, upper - lower, subset)
    return series_of(path, position[kept], points.displacement[:, kept] * upward)


def _specimen(name: str, forward: xr.Dataset, noise: Noise, window: float, kernel: str) -> Specimen:
    """The sheet as a configuration would describe it, if it were a real one."""
    width, height = (float(side) for side in np.ptp(forward["corners"].values, axis=0))
    share = Specimen.model_fields["force_uncertainty"].default
    return Specimen(
        folder=name,
        width=width,
        height=height,
        thickness=float(forward.attrs["thickness"]),
        outline="cut",
        # Every subset is whole.
        edge_ring=0,
        correlation_window=window,
        correlation_kernel=kernel,
        # The camera stands still.
        camera_motion=False,
        # Besides the load cell's, that of the share of the force which the grid carries.
        force_uncertainty=min(float(np.hypot(noise.force, share)), 1.0),
        force_gain_uncertainty=noise.force_gain,
        force_offset_uncertainty=noise.force_offset,
    )


def _load_cases(
    specimen: Specimen, loads: list[str], series: Series, forward: xr.Dataset, noise: Noise
) -> list[LoadCase]:
    """The tests, each with the reference and its own load steps."""
    number = forward["load_case"].values
    force = with_force_errors(forward["edge_force"].values, number, noise)
    cases = []
    for k, kind in enumerate(loads):
        steps = np.flatnonzero(number == k)
        frames = [series.frames[0], *(series.frames[step + 1] for step in steps)]
        load = kind if kind in get_args(SpecimenLoad) else "biaxial"
        test = specimen.model_copy(update={"load": load})
        pulls = {(i, J): _pull(force[steps], i, J) for i, J in RESULTANTS[kind]}
        cases.append(load_case_of(specimen, test, Series(series.x, series.y, frames, unit=series.unit), pulls))
    return cases


def _pull(force: Float[np.ndarray, "step edge 2"], i: int, J: int) -> Float[np.ndarray, " step"]:
    """What a load cell reads along i across the section normal to J: the mean of both ends."""
    low, high = (force[:, EDGE_NAMES.index(edge), i] for edge in _OPPOSITE[J])
    return 0.5 * (high - low)


def _truth(forward: xr.Dataset, sheet: ImportedSpecimen, corner: Float[np.ndarray, " 2"]) -> dict[str, np.ndarray]:
    """The displacement without errors at the measured points, as the camera saw it."""
    mesh, measured = mesh_of(forward), sheet.mesh
    u = np.stack(
        [NodalField.of(mesh, each).at(measured.nodes + corner) for each in followed(mesh, forward["u"].values)]
    )
    return {"u_truth": u, "F_truth": deformation_gradient(measured, u)}
