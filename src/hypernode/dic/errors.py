"""The error of every importer."""

from hypernode.errors import ExpectedError


class DicError(ExpectedError, ValueError):
    """A test folder cannot be used; the message names file and line and the way out."""
