"""The blocks of code in Markdown pages, and what the comments above them say of them.

A comment of HTML on a line of its own above a block, which no reader sees, is a mark:

- ``<!-- not run: REASON -->``: the block is left out.
- ``<!-- not run "LINE", "LINE": REASON -->``: lines that begin with these words are left out.
- ``<!-- file: PATH -->``: the block is the content of a file.
- ``<!-- before: COMMAND -->``: what has to be there first, and is no part of what the page tells.
- ``<!-- exit code N: REASON -->``: how the block ends.
"""

import re
from dataclasses import KW_ONLY, dataclass, field
from pathlib import Path

_FENCE = re.compile(r"^```(?P<language>[\w-]*)(?P<rest>.*)$")
_MARK = re.compile(r"^<!-- (?P<name>not run|file|before|exit code)(?P<what> [^:]*)?: (?P<text>.+) -->$")
_LINES = re.compile(r'"([^"]+)"')
#: Languages that are run, those that are checked, and those that are only shown.
RUN, CHECKED, SHOWN = ("sh", "python"), ("yaml",), ("text",)


@dataclass(frozen=True)
class Block:
    """A block of a page.

    Attributes:
        page, line: where it begins.
        language, text: what it holds.
        left_out: reason for which it is not run, or none.
        lines_left_out: how lines begin that are not run, and why.
        file: name of the file whose content it is.
        before: commands that are run first.
        exit_code: with which it ends.
    """

    page: Path
    line: int
    language: str
    text: str
    _: KW_ONLY
    left_out: str = ""
    lines_left_out: tuple[tuple[str, ...], str] = ((), "")
    file: str = ""
    before: tuple[str, ...] = field(default=())
    exit_code: int = 0

    @property
    def where(self) -> str:
        """Page and line."""
        return f"{self.page}:{self.line}"

    @property
    def code(self) -> str:
        """What is run of it."""
        beginnings = self.lines_left_out[0]
        return "\n".join(line for line in self.text.splitlines() if not (beginnings and line.startswith(beginnings)))


def blocks_of(page: Path, root: Path) -> list[Block]:
    """The blocks of a page, in order.

    Raises:
        ValueError: a mark is unknown or belongs to no block, or a block does not end.
    """
    found, marks, opened, lines = [], {}, None, []
    for number, line in enumerate((root / page).read_text(encoding="utf-8").splitlines(), start=1):
        fence = _FENCE.match(line)
        if opened is not None:
            if fence and not fence["language"]:
                found.append(Block(page, *opened, "\n".join(lines) + "\n", **marks))
                opened, lines, marks = None, [], {}
            else:
                lines.append(line)
        elif fence:
            opened = number, fence["language"]
        elif line.startswith("<!--"):
            _add(marks, line, f"{page}:{number}")
        elif line.strip() and marks:
            raise ValueError(f"{page}:{number}: the mark above belongs to no block")
    if opened is not None or marks:
        raise ValueError(f"{page}: ends within a block, or with a mark")
    return found


def _add(marks: dict, line: str, where: str) -> None:
    mark = _MARK.match(line)
    if mark is None:
        raise ValueError(f"{where}: {line} is no mark of a block")
    name, what, text = mark["name"], (mark["what"] or "").strip(), mark["text"]
    if name == "not run" and what:
        marks["lines_left_out"] = tuple(_LINES.findall(what)), text
    elif name == "not run":
        marks["left_out"] = text
    elif name == "file":
        marks["file"] = text
    elif name == "before":
        marks["before"] = (*marks.get("before", ()), text)
    else:
        marks["exit_code"] = int(what)
