"""Sentences of Markdown pages and of docstrings, and how many words each has."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

#: What is no prose of a page: blocks of code, comments, formulas on lines of their own, headings, tables, images.
_NO_PROSE = (
    (r"^(```|~~~).*?^\1", re.MULTILINE | re.DOTALL),
    (r"<!--.*?-->", re.DOTALL),
    (r"\$\$.*?\$\$", re.DOTALL),
    (r"^(#|\s*\||!\[|\([\w-]+\)=).*$", re.MULTILINE),
)
#: A new item of a list or of a section of a docstring, and an empty line.
_PARAGRAPH = re.compile(r"\n\s*(?:[-*]|\d+\.)\s+|\n\s*\n|\n *(?:Args|Raises|Returns|Attributes):|\n +[\w, ]+: ")
_SENTENCE = re.compile(r"(?<=[.!?])[)\"*_]*\s+(?=[\"'(*_`]*[\w`$\[/])")
#: One word each, whatever it holds: code, a formula, and what a link shows instead of where it leads.
_ONE_WORD = ((r"`[^`]*`", "code"), (r"\$[^$]*\$", "formula"), (r"\[([^\]]*)\]\([^)]*\)", r"\1"))
#: A line of a formula, such as ``P = dPsi / dF``.
_FORMULA = re.compile(r" (=|->) ")
_WORD = re.compile(r"[\w'./%+-]*\w[\w'./%+-]*")


def sentences(text: str) -> list[str]:
    """The sentences of Markdown or of a docstring; an item of a list ends one."""
    for pattern, flags in _NO_PROSE:
        text = re.sub(pattern, "\n\n", text, flags=flags)
    for pattern, word in _ONE_WORD:
        text = re.sub(pattern, word, text)
    paragraphs = [" ".join(part.split()) for part in _PARAGRAPH.split("\n" + text)]
    return [each for part in paragraphs for each in _SENTENCE.split(part) if each]


def words(sentence: str) -> int:
    """How many words a sentence has; a piece of code, a formula and a number are one each."""
    return len(_WORD.findall(sentence))


def docstrings(path: Path) -> Iterator[tuple[str, str]]:
    """Name and docstring of a module and of what is public in it, without formulas on lines of their own."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Module | ast.FunctionDef | ast.ClassDef):
            name = getattr(node, "name", "")
            if not name.startswith("_") and (text := ast.get_docstring(node)):
                parts = text.split("\n\n")
                yield name, "\n\n".join(part for part in parts if not all(map(_FORMULA.search, part.splitlines())))
