"""A table as HTML text."""

from collections.abc import Iterable
from html import escape


def html_table(name: str, caption: str, columns: Iterable[str], rows: Iterable[str]) -> str:
    """A table in a box that scrolls.

    Args:
        name: its identifier.
        caption, columns: as text.
        rows: as HTML text.
    """
    head = "".join(f'<th scope="col">{escape(column)}</th>' for column in columns)
    return (
        f'<div class="wide"><table id="{name}"><caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table></div>"
    )
