"""Stage of a photographed sheet: what is sprayed on it."""

import numpy as np

from hypernode.config.pictures import Speckle
from hypernode.pictures.speckle import sprayed
from hypernode.storage.netcdf import sheet_units, write


def run(settings: dict, name: str, output: str, attributes: dict) -> None:
    """Write where discs are, and how large.

    Args:
        settings: ``size`` of the sheet, ``mm_per_pixel``, both in its unit, its ``thickness`` or None, and ``speckle``.
    """
    pixel = settings["mm_per_pixel"]
    discs = sprayed(tuple(np.array(settings["size"]) / pixel), Speckle.model_validate(settings["speckle"]))
    write(
        output,
        {"disc_centre": discs.centre * pixel, "disc_radius": discs.radius * pixel},
        f"speckle on {name}",
        {**attributes, "units": sheet_units(settings["thickness"])},
    )
