"""What a wrong configuration raises."""

from hypernode.errors import ExpectedError


class ConfigError(ExpectedError, ValueError):
    """The configuration is wrong; the message is complete and needs no traceback."""
