"""The picture files of a real test: their order, their times, their grey values, and the region to follow."""

import re
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, UInt

from hypernode.pictures.errors import PictureError

#: Seconds at the end of a file's name, with a decimal point: `name.000438.870.jpg`, `name_12.5 s.tif`.
_SECONDS = re.compile(r"(\d+\.\d+) ?s?\.\w+$")
#: Column, row, width and height of a rectangle [pixel].
Region = tuple[int, int, int, int]


def picture_files(folder: Path, pattern: str, reference: str = "first", every: int = 1) -> list[Path]:
    """Pictures of a test in the order in which they are compared: the reference, then by name away from it.

    Args:
        pattern: of the names, as ``*.tif``.
        reference: ``first`` or ``last`` of the names: the least loaded picture.
        every: how many names a picture stands for.

    Raises:
        PictureError: fewer than two are there.
    """
    found = sorted(path for path in folder.glob(pattern) if path.is_file())
    chosen = (found[::-1] if reference == "last" else found)[::every]
    if len(chosen) < 2:
        raise PictureError(
            f"{folder}: {len(found)} pictures are named {pattern}, of which every {every} makes {len(chosen)}: two or "
            "more are compared"
        )
    return chosen


def seconds_of(paths: list[Path]) -> Float[np.ndarray, " picture"] | None:
    """Times that the names end in [s]; None where one of them does not."""
    found = [_SECONDS.search(path.name) for path in paths]
    return np.array([float(match[1]) for match in found]) if all(found) else None


def read_pictures(paths: list[Path]) -> UInt[np.ndarray, "frame row column"]:
    """Grey values of pictures of one size, of 8 or 16 bit as the files have them. Colours count by their luminance.

    Raises:
        PictureError: one of them cannot be read, or has another size.
    """
    from PIL import Image, UnidentifiedImageError

    grey = []
    for path in paths:
        try:
            with Image.open(path) as picture:
                grey.append(np.asarray(picture if picture.mode.startswith("I;16") else picture.convert("L")))
        except (UnidentifiedImageError, OSError) as error:
            raise PictureError(f"{path}: cannot be read as a picture: {error}") from None
        if (grey[-1].shape, grey[-1].dtype) != (grey[0].shape, grey[0].dtype):
            raise PictureError(
                f"{path}: {grey[-1].shape} rows and columns of {grey[-1].dtype}, {paths[0].name} has {grey[0].shape} "
                f"of {grey[0].dtype}"
            )
    return np.stack(grey)


def region_mask(
    shape: tuple[int, int], region: Region | None = None, mask: Path | None = None
) -> Bool[np.ndarray, "row column"]:
    """Pixels of the reference to follow: a rectangle, what a picture shows white, or both.

    Raises:
        PictureError: nothing is left, or the rectangle or the picture does not fit.
    """
    inside = np.ones(shape, bool)
    if region:
        column, row, width, height = region
        if min(column, row, width - 1, height - 1) < 0 or column + width > shape[1] or row + height > shape[0]:
            raise PictureError(f"region {region}: beyond pictures of {shape[1]} columns and {shape[0]} rows")
        inside[:] = False
        inside[row : row + height, column : column + width] = True
    if mask:
        white = read_pictures([mask])[0]
        if white.shape != shape:
            raise PictureError(f"{mask}: {white.shape} rows and columns, the pictures have {shape}")
        inside &= white > np.iinfo(white.dtype).max // 2
    if not inside.any():
        raise PictureError("region and mask leave no pixel to follow")
    return inside
