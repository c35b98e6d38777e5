"""Text in whatever encoding a laboratory's software writes it."""

import codecs
import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TypeVar

from hypernode.dic.dialect import NOT_A_NUMBER
from hypernode.dic.errors import DicError

#: Largest file that is read; a frame of ten million points is far below it.
MAX_BYTES = 2_000_000_000
#: Code pages of Japanese, Chinese, Cyrillic and Central European Windows.
_CODE_PAGES = ("shift_jis", "gb18030", "cp1251", "cp1250")
#: A comment, or a word of three letters at least: shorter ones are damaged numbers as well.
_SAID = re.compile(r"[\s\"']*(?:#|//|%|[^\W\d_]{3,})")
#: Words that stand for a number.
_NUMBERS = "|".join(map(re.escape, (*filter(None, NOT_A_NUMBER), "infinity", "inf", "true", "false")))
_NUMBER = re.compile(rf"[\s\"']*(?:{_NUMBERS})(?![^\W\d_])", re.IGNORECASE)
#: A row as text, or as cells.
Row = TypeVar("Row")


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


def readings(path: Path) -> Iterator[str]:
    """A file as text. If it is not in UTF-8, the texts in code pages of other alphabets follow.

    Only the words of a header differ: numbers are alike in all of them.

    Raises:
        DicError: as :func:`read_text`.
    """
    text = read_text(path)
    yield text
    content = path.read_bytes()
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) or content.isascii():
        return
    for code in _CODE_PAGES:
        try:
            other = content.decode(code)
        except UnicodeDecodeError:
            continue
        if other != text:
            yield other


def without_last_words(rows: list[Row], first: Callable[[Row], str]) -> list[Row]:
    """Rows of a table without what a program adds below them: lines that begin with a word, or as comments do.

    A table whose first row begins so names its rows, and keeps all of them.

    Args:
        rows: lines, or cells of each, none of them empty.
        first: text with which a row begins.
    """
    if not rows or _is_said(first(rows[0])):
        return rows
    last = next((k for k in range(len(rows), 0, -1) if not _is_said(first(rows[k - 1]))), 0)
    return rows[:last]


def _is_said(text: str) -> bool:
    return bool(_SAID.match(text) and not _NUMBER.match(text))


def refuse_cut_lines(paths: Iterable[Path]) -> None:
    """Nothing, where all files of one program end their last line, or none does.

    A number that is cut is a number still, and no reader can tell: but its line has no end.

    Raises:
        DicError: some files end their last line and another, which is not empty, does not.
    """
    whole, cut = None, None
    for path in paths:
        with open(path, "rb") as handle:
            size = handle.seek(0, 2)
            handle.seek(max(size - 2, 0))
            ended = handle.read().strip(b"\0")[-1:] in (b"\n", b"\r")
        if not size:
            continue
        whole, cut = (whole or path, cut) if ended else (whole, cut or path)
        if whole and cut:
            line = len(read_text(cut).splitlines())
            raise DicError(
                f"{cut}:{line}: the last line has no end, as that of {whole.name} has: the file is cut off; copy or "
                "export it again"
            )


def without_braces(files: Iterable[str]) -> list[str]:
    """The same files.

    Raises:
        DicError: a name has braces, in which the workflow looks for the name of a wildcard.
    """
    files = list(files)
    for file in files:
        if "{" in file or "}" in file:
            raise DicError(
                f"{file}: the workflow cannot name a file with braces: rename it or its folder, or link to the folder "
                "under another name, ln -s FOLDER NAME"
            )
    return files


def shown(names: Iterable[str], most: int = 100) -> str:
    """Names for a message, as many characters of them as fit into it."""
    text = ", ".join(map(repr, names))
    return text if len(text) <= most else text[:most] + " ..."
