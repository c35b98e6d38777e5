"""What pictures that cannot be correlated raise."""

from hypernode.errors import ExpectedError


class PictureError(ExpectedError, ValueError):
    """Pictures, or what should be done with them, cannot be right; the message is complete."""


class EngineMissing(PictureError):
    """The environment of a correlation engine is not there."""
