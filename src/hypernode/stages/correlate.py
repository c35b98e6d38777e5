"""Stage of a photographed sheet: points followed through its pictures by an engine for image correlation."""

import numpy as np

from hypernode.config.correlation import Correlation
from hypernode.pictures.correlation import correlate
from hypernode.pictures.sensitivity import least_noise
from hypernode.progress import say
from hypernode.storage.netcdf import read, units_of, write

#: What a file of correlated points keeps of that of the pictures: where pixels lie on the sheet.
PLACE = ("mm_per_pixel", "origin_column", "origin_row")


def run(settings: dict, name: str, pictures_file: str, output: str, threads: int, attributes: dict) -> None:
    """Write the displacements of points on a square grid, in pixels, rows downward.

    Args:
        settings: of the engine.

    Raises:
        PictureError: the engine is not installed, or gave up.
    """
    pictures, chosen = read(pictures_file), Correlation.model_validate(settings)
    frames, rows, columns = pictures["picture"].shape
    say("correlate", name, f"{frames} pictures of {columns} x {rows} pixels by {chosen.engine}")
    on_sheet = pictures["on_sheet"].values > 0
    found = correlate(pictures["picture"].values, on_sheet, chosen, threads)
    floor = least_noise(pictures["picture"].values[0], on_sheet, float(pictures.attrs["grey_noise"]), chosen.subset)
    lost = np.isnan(found.displacement).any(axis=-1)
    say("correlate", name, f"{lost.shape[1]} points, of which at most {lost.sum(axis=1).max()} are lost in a picture")
    stored = found.to_dataset()
    write(
        output,
        {key: stored[key].values for key in stored},
        f"correlated points of {name}",
        {
            **attributes,
            **stored.attrs,
            **{key: pictures.attrs[key] for key in PLACE},
            "subset": chosen.subset,
            "least_noise": floor.tolist(),
            "units": units_of(pictures),
        },
        parents=[pictures_file],
    )
