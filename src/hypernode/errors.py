"""The one base of errors that a user can mend."""


class ExpectedError(Exception):
    """Something that the configuration, the input or the disk is to blame for.

    Its message is complete: a job that ends with one prints that line and no traceback.
    """
