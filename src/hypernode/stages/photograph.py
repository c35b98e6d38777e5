"""Stage of a photographed sheet: what the camera records of it."""

from dataclasses import asdict

import numpy as np

from hypernode.config.pictures import Pictures
from hypernode.data.measurement import mesh_of
from hypernode.fem.interpolation import NodalField
from hypernode.pictures.photograph import followed, light, recorded, sheet_mask
from hypernode.pictures.speckle import Discs, Pattern
from hypernode.pictures.view import view_of
from hypernode.progress import Progress
from hypernode.storage.netcdf import read, units_of, write


def run(settings: dict, name: str, forward_file: str, speckle_file: str, output: str, attributes: dict) -> None:
    """Write a picture of the sheet at rest and one of each load step.

    Args:
        settings: ``mm_per_pixel``, in the unit of the sheet, and ``pictures``.

    Raises:
        ValueError: the sheet is folded over, or the lens moves it out of the picture.
    """
    forward, speckle, pixel = read(forward_file), read(speckle_file), settings["mm_per_pixel"]
    pictures = Pictures.model_validate(settings["pictures"])
    mesh = mesh_of(forward)
    u = np.concatenate([np.zeros((1, *mesh.nodes.shape)), followed(mesh, forward["u"].values)])
    view = view_of(mesh.nodes + u, pixel, pictures.margin, pictures.distortion)
    discs = Discs((speckle["disc_centre"].values - mesh.lower) / pixel, speckle["disc_radius"].values / pixel)
    pattern = Pattern.of(discs, tuple(mesh.size / pixel))
    progress, taken = Progress("photograph", name, len(u)), []
    for frame, each in enumerate(u):
        taken.append(recorded(light(pattern, NodalField.of(mesh, each), view, pictures), pictures, frame))
        progress.advance(stretch=float(forward["stretch"].values[frame - 1]) if frame else 1.0)
    on_sheet = sheet_mask(NodalField.of(mesh, u[0]), view)
    # That of rounding is even over one level.
    grey_noise = float(np.hypot(pictures.noise, 12.0**-0.5))
    write(
        output,
        {"picture": np.stack(taken), "on_sheet": on_sheet.astype(np.uint8)},
        f"pictures of {name}",
        {**attributes, **asdict(view), "grey_noise": grey_noise, "units": units_of(forward)},
        parents=[forward_file, speckle_file],
    )
