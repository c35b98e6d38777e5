"""Text in whatever encoding a laboratory's software writes it."""

import codecs
from pathlib import Path

from hypernode.dic.errors import DicError

#: Largest file that is read; a frame of ten million points is far below it.
MAX_BYTES = 2_000_000_000


def read_text(path: Path, limit: int = MAX_BYTES) -> str:
    """A file, or its first ``limit`` bytes: UTF-8, or UTF-16 where it says so, else the code page of Western Windows.

    Raises:
        DicError: the file cannot be read, is too large, or is no text.
    """
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise DicError(f"{path}: larger than {MAX_BYTES} bytes: neither a frame nor a record")
        with open(path, "rb") as handle:
            content = handle.read(limit)
    except OSError as error:
        raise DicError(f"{path}: cannot be read: {error.strerror}") from None
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return content.decode("utf-16", errors="replace")
    if b"\0" in content:
        raise DicError(f"{path}: cannot be read as text: it holds zero bytes")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")
