"""What can go wrong while an explorer is made."""

from hypernode.errors import ExpectedError


class ExplorerError(ExpectedError, ValueError):
    """A run cannot be shown; the message says why, and the way out."""
