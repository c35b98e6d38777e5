"""How sure the stress and its level are, a row of HTML for each run."""

import json
from html import escape

import xarray as xr

from hypernode.evaluation.doubt import ASKED
from hypernode.evaluation.level_budget import INPUTS, TOTAL
from hypernode.evaluation.limits import percent
from hypernode.explorer.html_table import html_table


def doubt_row(name: str, evaluation: xr.Dataset) -> str:
    """Doubt in every mode at the stretch of the test; empty where nothing tells it."""
    doubt = json.loads(evaluation.attrs.get("doubt", "[]"))
    of_test = {
        one["mode"]: percent(one["total"]) + ("" if one["inside"] else " (beyond)")
        for one in doubt
        if one["reach"] == 1.0
    }
    return _row(name, [of_test.get(mode, "") for mode in ASKED]) if doubt else ""


def doubt_table(rows: list[str]) -> str:
    """The rows of :func:`doubt_row`, or nothing."""
    caption = "Standard uncertainty of the stress by mode, at the stretch of the test; beyond: of what it has not seen"
    columns = [mode.replace("_", " ") for mode in ASKED]
    return _titled("Doubt in every deformation", "doubt", caption, columns, rows)


def budget_row(name: str, evaluation: xr.Dataset) -> str:
    """Parts of the level's uncertainty, a star where the test told of the input; empty where there is no budget."""
    parts = {row["input"]: row for row in json.loads(evaluation.attrs.get("level_budget", "[]"))}
    shown = {key: percent(row["level"]) + (" *" if row.get("told_by") else "") for key, row in parts.items()}
    return _row(name, [shown.get(key, "") for key in (TOTAL, *INPUTS)]) if parts else ""


def budget_table(rows: list[str]) -> str:
    """The rows of :func:`budget_row`, or nothing."""
    caption = "Standard uncertainty of the level of the stress, and its parts; a star: the test tells of it"
    return _titled("Where the level comes from", "budget", caption, [TOTAL, *INPUTS], rows)


def _row(name: str, cells: list[str]) -> str:
    shown = "".join(f'<td class="number">{escape(cell)}</td>' for cell in cells)
    return f'<tr><th scope="row">{escape(name)}</th>{shown}</tr>'


def _titled(title: str, name: str, caption: str, columns: list[str], rows: list[str]) -> str:
    known = sorted(filter(None, rows))
    return f"<h2>{title}</h2>" + html_table(name, caption, ("run", *columns), known) if known else ""
