"""Errors of the challenge."""

from hypernode.errors import ExpectedError


class ChallengeError(ExpectedError, ValueError):
    """A file is no test of the challenge, or classes cannot be told; the message says why and what to do."""
