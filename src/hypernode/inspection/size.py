"""How large the sheet and a pixel are, and whether the measured field fits onto it."""

from collections.abc import Mapping

from hypernode.dic.specimen import BEYOND
from hypernode.inspection.field import Field
from hypernode.inspection.known import ANY_SIZE, Known, guessed, missing, odd
from hypernode.mechanics.loads import tensile_axis

#: Share of both sides below which a field is of another unit sooner than of a part of the sheet: a tenth, as cm for mm
#: make, and what a size is rounded by.
_HARDLY = 0.11
#: Digits of a guess: it is no better than the difference above.
_DIGITS = 4
_PIXEL = "the length of a pixel on the sheet in mm, --pixel-size MM"


def size_known(given: Mapping[str, object], field: Field, load: str) -> Known:
    """What is known of the size of sheet and pixel.

    Args:
        given: keys of the specimen.
        field: the frames.
        load: kind of load.
    """
    pixels = field.series.unit == "pixel"
    if not ANY_SIZE.keys() <= given.keys():
        spans = "" if pixels else f"; the field spans {field.extent[0]:.4g} x {field.extent[1]:.4g} mm"
        absent = ", ".join(key for key in ANY_SIZE if key not in given)
        known = missing(f"{absent} of the sheet in mm{spans}: --size WIDTH HEIGHT THICKNESS", "width")
        if pixels and "pixel_size" not in given:
            known += missing(_PIXEL + "; with the size it may be guessed", "pixel_size")
        return known
    if not pixels:
        return _misfit(given, field.extent)
    if "pixel_size" in given:
        return _misfit(given, tuple(given["pixel_size"] * pixel for pixel in field.extent))
    return _pixel(given, field.extent, load)


def _pixel(given: Mapping[str, object], extent: tuple[float, float], load: str) -> Known:
    """The length of a pixel from the field's extent across the pull, where both axes agree."""
    sizes = (given["width"], given["height"])
    found = [size / points for size, points in zip(sizes, extent, strict=True)]
    if max(found) > (1.0 + BEYOND) * min(found):
        return missing(
            f"{_PIXEL}: the field of {extent[0]:.4g} x {extent[1]:.4g} pixels is not "
            f"alike to a sheet of {sizes[0]:.4g} x {sizes[1]:.4g} mm ({found[0]:.4g} and {found[1]:.4g} mm a pixel)",
            "pixel_size",
        )
    pull = tensile_axis(load)
    across = 0 if pull is None else 1 - pull
    return guessed(
        "pixel_size",
        float(f"{found[across]:.{_DIGITS}g}"),
        f"the field of {extent[across]:.4g} pixels along {'xy'[across]} taken for the whole {sizes[across]:.4g} mm of "
        f"the sheet; along {'yx'[across]} it would be {found[1 - across]:.4g}",
    )


def _misfit(given: Mapping[str, object], extent: tuple[float, float]) -> Known:
    """What is strange about a field [mm] that is larger than its sheet, or a spot of it."""
    for key, points in zip(("width", "height"), extent, strict=True):
        if points > (1.0 + BEYOND) * given[key]:
            return odd(
                f"the field is {extent[0]:.4g} x {extent[1]:.4g} mm and the sheet {given['width']:.4g} x "
                f"{given['height']:.4g} mm: points lie beyond it; check the size and pixel_size",
                key,
            )
    if all(points < _HARDLY * given[key] for key, points in zip(("width", "height"), extent, strict=True)):
        return odd(
            f"the field is {extent[0]:.4g} x {extent[1]:.4g} mm, hardly a spot of the sheet of {given['width']:.4g} x "
            f"{given['height']:.4g} mm: check the size, pixel_size and the unit of the files",
            "width",
        )
    return Known()
