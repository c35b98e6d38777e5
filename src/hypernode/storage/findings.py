"""What an audit says of one file."""

from dataclasses import dataclass

from hypernode.storage.errors import StorageError


@dataclass(frozen=True)
class Finding:
    """One sentence about one file: a problem, or a notice of what may but need not change a number."""

    file: str
    message: str
    notice: bool = False

    def __str__(self):
        return f"{'notice: ' if self.notice else ''}{self.file}: {self.message}"


def refused(error: StorageError) -> Finding:
    """The finding of a file that its reader has refused: the error names the file first."""
    file, _, message = str(error).partition(": ")
    return Finding(file, message)
