"""Arrays as short text that the page turns back into numbers."""

import base64
import zlib

import numpy as np
from jaxtyping import Float, Integer

#: Bits of a number where nothing asks for fewer.
BITS = 16
#: Values of a row up to which they are listed and numbered, which loses nothing.
FEW = 256


def _rows(values: Float[np.ndarray, "... point"]) -> Float[np.ndarray, "row point"]:
    return np.asarray(values, float).reshape(-1, np.shape(values)[-1])


def _few_values(rows: Float[np.ndarray, "row point"]) -> list[np.ndarray] | None:
    """The values of every row, in order, or None where a row has many or one that is no number."""
    if not np.isfinite(rows).all():
        return None
    found = [np.unique(row) for row in rows]
    return found if max(map(len, found), default=0) <= FEW else None


def _quantised(
    rows: Float[np.ndarray, "row point"], bits: int
) -> tuple[Integer[np.ndarray, "row point"], Float[np.ndarray, " row"], Float[np.ndarray, " row"]]:
    """(numbers of the steps, lowest value, step) of every row; the last number stands for NaN.

    Whole numbers stay as they are where there are enough bits.
    """
    known = np.isfinite(rows)
    low = np.where(known, rows, np.inf).min(axis=1)
    high = np.where(known, rows, -np.inf).max(axis=1)
    low, high = (np.where(np.isfinite(each), each, 0.0) for each in (low, high))
    nan = 2**bits - 1
    step = np.where(high > low, (high - low) / (nan - 1), 1.0)
    whole = (np.where(known, rows % 1.0, 0.0) == 0.0).all(axis=1) & (high - low < nan)
    step = np.where(whole, 1.0, step)
    codes = np.rint((np.where(known, rows, low[:, None]) - low[:, None]) / step[:, None])
    return np.where(known, codes, nan).astype(int), low, step


def restored(values: Float[np.ndarray, "... point"], bits: int) -> Float[np.ndarray, "... point"]:
    """The numbers that the page has in the place of some."""
    rows = _rows(values)
    if _few_values(rows) is not None:
        return np.asarray(values, float)
    codes, low, step = _quantised(rows, bits)
    found = np.where(codes == 2**bits - 1, np.nan, low[:, None] + step[:, None] * codes)
    return found.reshape(np.shape(values))


class Arrays:
    """Arrays one after the other in one stream of bytes."""

    def __init__(self):
        self._parts: list[bytes] = []

    def add(self, values: Float[np.ndarray, "... point"], bits: int = BITS) -> dict:
        """Append an array; the last axis is that along which values share their lowest value and step.

        Args:
            values: numbers or NaN.
            bits: of each number, 24 at most; rows of few different values keep them as they are.

        Returns:
            How to find it again: position in the stream, number of bytes of a value, shape, and ``levels``, the values
            of every row, or ``low``, ``step`` and the number ``nan``.
        """
        rows = _rows(values)
        few = _few_values(rows)
        if few is not None:
            codes = np.array([np.searchsorted(levels, row) for levels, row in zip(few, rows, strict=True)])
            entry = {"levels": [levels.tolist() for levels in few]}
        else:
            codes, low, step = _quantised(rows, bits)
            entry = {"low": low.tolist(), "step": step.tolist(), "nan": 2**bits - 1}
        size = 1 if few is not None else (bits + 7) // 8
        entry |= {"at": sum(map(len, self._parts)), "bytes": size, "shape": list(np.shape(values))}
        # All low bytes and then all high ones: they are alike among themselves and take less room.
        self._parts += [(codes >> 8 * plane & 255).astype(np.uint8).tobytes() for plane in range(size)]
        return entry

    @property
    def text(self) -> str:
        """The stream, compressed and as letters."""
        return base64.b64encode(zlib.compress(b"".join(self._parts), 9)).decode("ascii")
