"""A table before it is written: every number unrounded, and what of it is shown."""

from dataclasses import KW_ONLY, dataclass, field

import pandas as pd

from hypernode.tables.columns import JUDGED_AT, Column


@dataclass(frozen=True)
class Table:
    """One table.

    Attributes:
        frame: one row a row, with label columns first, then every column unrounded.
        columns: name -> column, for every column of ``frame`` that is no label.
        shown: names of the columns that people read.
        best: (index of the row, name) of the values that are marked.
        notes: sentences under the table.
    """

    frame: pd.DataFrame
    columns: dict[str, Column]
    shown: list[str]
    _: KW_ONLY
    best: set[tuple[int, str]] = field(default_factory=set)
    notes: list[str] = field(default_factory=list)

    @property
    def labels(self) -> list[str]:
        """Names of the columns that say which row is which."""
        return [name for name in self.frame.columns if name not in self.columns]


def make_frame(rows: list[dict], labels: list[str], columns: dict[str, Column]) -> pd.DataFrame:
    """Rows as a frame whose columns have the types of their styles, empty where a row lacks a value."""
    frame = pd.DataFrame(rows, columns=[*labels, *columns])
    types = {"count": "Int64", "text": "object"}
    return frame.astype({name: types.get(column.style, "float64") for name, column in columns.items()})


def best_values(frame: pd.DataFrame, columns: dict[str, Column], within: str) -> set[tuple[int, str]]:
    """The best value of every column among rows that share a label, with those that print alike.

    Nothing is marked where a row is alone, or where all values print alike.

    Args:
        frame: the rows that are compared.
        columns: name -> column.
        within: the label.
    """
    marked = set()
    for _, rows in frame.groupby(within, sort=False):
        for name, column in columns.items():
            values = rows[name].dropna() if column.better else rows[name][:0]
            if not len(values):
                continue
            best = column.shown(values.min() if column.better == "low" else values.max())
            winners = [index for index, value in values.items() if column.shown(value) == best]
            if len(winners) < len(values):
                marked |= {(index, name) for index in winners}
    return marked


def judged_notes(columns: dict[str, Column], shown: list[str]) -> list[str]:
    """A sentence for every deformation at which columns that are shown were judged."""
    notes = []
    for key, words in JUDGED_AT.items():
        names = [name for name in shown if columns[name].judged_at == key]
        if names:
            notes.append(f"{'; '.join(names)}: {words}.")
    return notes
