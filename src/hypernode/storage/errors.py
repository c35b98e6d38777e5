"""What storage refuses."""

from hypernode.errors import ExpectedError


class StorageError(ExpectedError, RuntimeError):
    """A result file is missing, damaged or breaks the schema; the message names file and variable."""
