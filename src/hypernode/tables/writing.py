"""A table as files: CSV with every number as it is, Markdown and LaTeX with what people read."""

import re
from collections.abc import Mapping
from pathlib import Path

import pandas as pd

from hypernode.storage.netcdf import sha256, write_bytes_atomically
from hypernode.tables.table import Table

#: Characters beyond which a column of text breaks its lines.
LONG = 40
_LATEX = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": "$<$",
    ">": "$>$",
    **{sign: "\\" + sign for sign in "&%$#_{}"},
}


def csv_text(table: Table) -> str:
    """Every column with its unit in the files, and every digit."""
    headers = {name: column.header(name, stored=True) for name, column in table.columns.items()}
    return table.frame.rename(columns=headers).to_csv(index=False, lineterminator="\n")


def markdown_text(table: Table) -> str:
    """The columns that are shown, the best values in bold, and the notes in a line each."""
    heads, rows = _cells(table, _markdown, "**{}**".format)
    lines = ["| " + " | ".join(cells) + " |" for cells in (heads, *rows)]
    lines.insert(1, "|" + "".join(f" {'---' if text else '---:'} |" for text in _is_text(table)))
    return "\n".join([*lines, *(f"\n{_markdown(note)}" for note in table.notes)]) + "\n"


def latex_text(table: Table) -> str:
    """The same as a ``tabular`` of the package booktabs, with the notes under it."""
    heads, rows = _cells(table, _latex, r"\textbf{{{}}}".format)
    wide = [max(map(len, cells), default=0) > LONG for cells in zip(*rows, strict=True)] or [False] * len(heads)
    places = [
        "r" if not text else r"p{0.6\linewidth}" if w else "l" for text, w in zip(_is_text(table), wide, strict=True)
    ]
    lines = [
        r"\begin{tabular}{" + "".join(places) + "}",
        r"\toprule",
        " & ".join(heads) + r" \\",
        r"\midrule",
        *(" & ".join(cells) + r" \\" for cells in rows),
        r"\bottomrule",
        r"\end{tabular}",
        *(rf"\par{{\footnotesize {_latex(note)}}}" for note in table.notes),
    ]
    return "\n".join(lines) + "\n"


def write_table(table: Table, files: Mapping[str, str], provenance: dict, parents: list[str], raw_inputs=()) -> None:
    """Write a table in every format.

    Args:
        table: what to write.
        files: ``csv``, ``markdown`` and ``latex``: paths.
        provenance: what the job says of itself.
        parents: result files that its numbers come from.
        raw_inputs: other files that they come from.

    Raises:
        StorageError: the disk refuses.
    """
    provenance = {**provenance, "raw_inputs": {path: sha256(path) for path in raw_inputs}}
    for kind, text in (("csv", csv_text), ("markdown", markdown_text), ("latex", latex_text)):
        content = text(table)
        write_bytes_atomically(
            files[kind],
            lambda temporary, content=content: Path(temporary).write_text(content, encoding="utf-8"),
            provenance,
            parents,
        )


def _cells(table: Table, escape, bold) -> tuple[list[str], list[list[str]]]:
    """(heads, cells of every row), escaped, with the best values in bold."""
    heads = [*table.labels, *(table.columns[name].header(name) for name in table.shown)]
    rows = []
    for index in table.frame.index:
        cells = [escape(str(table.frame.at[index, name])) for name in table.labels]
        for name in table.shown:
            value = table.frame.at[index, name]
            text = escape(table.columns[name].shown(None if pd.isna(value) else value))
            cells.append(bold(text) if (index, name) in table.best else text)
        rows.append(cells)
    return [escape(head) for head in heads], rows


def _is_text(table: Table) -> list[bool]:
    return [True] * len(table.labels) + [table.columns[name].style == "text" for name in table.shown]


def _markdown(text: str) -> str:
    return re.sub(r"([|*_<>])", r"\\\1", text)


def _latex(text: str) -> str:
    return "".join(_LATEX.get(sign, sign) for sign in text)
