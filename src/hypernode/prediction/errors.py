"""Errors of a prediction."""

from hypernode.errors import ExpectedError


class PredictionError(ExpectedError, ValueError):
    """A sheet cannot be predicted; the message says what is missing and where to get it."""
