"""Stage of a photographed sheet: points followed through its pictures, and what grey levels themselves say."""

import numpy as np

from hypernode.config.correlation import Correlation
from hypernode.pictures.correlation import Correlated, check, correlate
from hypernode.pictures.finite_elements import on_sheet as on_sheet_of
from hypernode.pictures.finite_elements import seen_by_elements
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
    grey, grey_noise = pictures["picture"].values, float(pictures.attrs["grey_noise"])
    told = {}
    if chosen.engine == "finite_elements":
        check(grey, on_sheet, chosen)
        seen = seen_by_elements(grey, on_sheet, chosen.step, grey_noise)
        found, noise = Correlated.of_nodes(seen, chosen.step), {"scatter": seen.noise, "level": seen.level}
        origin = np.array([pictures.attrs[key] for key in PLACE[1:]])
        told = on_sheet_of(seen.information, float(pictures.attrs[PLACE[0]]), origin).to_variables()
        ratio = ", ".join(f"{each:.3g}" for each in seen.grey_noise / grey_noise)
        say("correlate", name, f"grey levels of each picture are missed by {ratio} times their noise")
    else:
        found = correlate(grey, on_sheet, chosen, threads)
        noise = {"least": least_noise(grey[0], on_sheet, grey_noise, chosen.subset)}
    lost = np.isnan(found.displacement).any(axis=-1)
    say("correlate", name, f"{lost.shape[1]} points, of which at most {lost.sum(axis=1).max()} are lost in a picture")
    if lost.any():
        frame, point = np.argwhere(lost)[0]
        where = f"column {found.column[point]}, row {found.row[point]} of picture {frame}"
        say("correlate", name, f"the first lost one, without texture or too unlike the first picture: {where}")
    stored = found.to_dataset()
    write(
        output,
        {key: stored[key].values for key in stored} | told,
        f"correlated points of {name}",
        {
            **attributes,
            **stored.attrs,
            **{key: pictures.attrs[key] for key in PLACE},
            "subset": chosen.footprint,
            **{f"{key}_noise": value.tolist() for key, value in noise.items()},
            "units": units_of(pictures),
        },
        parents=[pictures_file],
    )
