"""A test as its frames: displacements on one grid, in the unit of the files."""

from dataclasses import KW_ONLY, dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Float

from hypernode.dic.errors import DicError


@dataclass(frozen=True)
class Frame:
    """Displacements of one frame on the series' grid, in its unit, y upward, NaN where lost.

    Attributes:
        time, force, crosshead: what the file itself says, in s, N and mm as far as it is right about its units;
            ``None`` where it says nothing. Some exports write volts where they promise newtons: compare with the
            machine's record.
    """

    number: int
    displacement: Float[np.ndarray, "row column 2"]
    _: KW_ONLY
    time: float | None = None
    force: float | None = None
    crosshead: float | None = None


@dataclass(frozen=True)
class Series:
    """Every frame of a test on one grid.

    Attributes:
        x, y: grid coordinates in ``unit``, increasing, y upward, both from 0.
        frames: in order of their number; the first is the reference.
        unit: ``pixel`` or ``mm``.
        out_of_plane: largest range of the out-of-plane displacement in a frame over the size of the sheet.
        files: every file that was read.
        tilt: angle from x of the files to x of the grid, y upward, in (-45, 45] degrees; displacements are along the
            grid's axes.
        inserted: numbers of pictures that took no time: those after them are earlier.
        findings: sentences on what of the frames cannot be a measurement.
    """

    x: Float[np.ndarray, " column"]
    y: Float[np.ndarray, " row"]
    frames: list[Frame]
    _: KW_ONLY
    unit: str = "pixel"
    out_of_plane: float = 0.0
    files: tuple[Path, ...] = field(default=())
    tilt: float = 0.0
    inserted: tuple[int, ...] = ()
    findings: tuple[str, ...] = ()

    def millimetres(self, pixel_size: float | None) -> float:
        """Length of the unit in mm; ``pixel_size`` is that of a pixel and matters for pixels alone.

        Raises:
            DicError: the unit is the pixel and its size is not given.
        """
        if self.unit == "mm":
            return 1.0
        if pixel_size is None:
            where = self.files[0].parent if self.files else "the series"
            raise DicError(f"{where}: the files are in pixels: give pixel_size, the length of a pixel in mm")
        return pixel_size
