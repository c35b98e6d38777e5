"""LaVision DaVis exports: one semicolon-separated file a frame, pixels, y downward."""

from hypernode.errors import ExpectedError


class DicError(ExpectedError, ValueError):
    """A test folder cannot be used; the message names file and line and the way out."""
