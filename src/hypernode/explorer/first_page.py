"""The first page of a results folder: what was run, how far it can be believed, and where everything is."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from html import escape
from importlib.resources import files as package_files

import numpy as np
import xarray as xr

from hypernode.evaluation.limits import percent
from hypernode.evaluation.thresholds import SETTINGS
from hypernode.explorer.facts import FACTS, fact
from hypernode.explorer.html_table import html_table
from hypernode.explorer.uncertainties import budget_row, budget_table, doubt_row, doubt_table
from hypernode.tables.verdicts import RunVerdict, count
from hypernode.verdict import Verdict

#: Formats of figures and tables, the one that is looked at first.
FIGURE_FORMATS, TABLE_FORMATS = ("png", "pdf"), ("md", "csv", "tex")
#: Longer side of a map, in pixels.
MAP_SIDE = 120.0
#: File of rules -> what they are about, in the order in which results are made.
TOPICS = {
    "forward": "The sheet",
    "pictures": "Its pictures",
    "measurement": "What was measured",
    "interpolant": "Deformation and equilibrium field",
    "inverse": "The material",
    "evaluation": "How good it is",
    "population": "Many sheets at once",
    "figures": "Figures and tables",
    "explorer": "Explorers",
    "first_page": "This page",
    "crate": "Where it came from",
}
_HEAD = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; img-src data:">
<link rel="icon" href="data:,">
<title>Results of hypernode</title>
<style>{style}</style>
</head>
<body>
<a class="skip" href="#verdicts">Skip to the verdicts</a>
<header><h1>Results of hypernode</h1>{told}</header>
<main>{main}</main>
</body>
</html>
"""


@dataclass(frozen=True, kw_only=True)
class _Run:
    """What the page shows of one run.

    Attributes:
        name: case and method.
        summary: numbers of its evaluation.
        doubt: row of its doubt by mode, empty where it knows none.
        budget: row of the parts of its level's uncertainty, empty where the level is a convention.
        refuted: small map of where its law is refuted, empty where it is not.
    """

    name: str
    verdict: Verdict
    summary: Mapping
    doubt: str
    budget: str
    refuted: str

    @classmethod
    def of(cls, evaluation: xr.Dataset) -> "_Run":
        """That of an opened evaluation, which is not kept."""
        name, verdict = RunVerdict.of(evaluation)
        summary = json.loads(evaluation.attrs["summary"])
        rows = {"doubt": doubt_row(name, evaluation), "budget": budget_row(name, evaluation)}
        return cls(name=name, verdict=verdict, summary=summary, refuted=_refuted_map(name, evaluation), **rows)


def first_page(evaluations: Iterable[xr.Dataset], commits: Mapping[str, int], settings: Mapping) -> str:
    """The HTML text of the page; it loads nothing, and its links are relative to the results folder.

    Args:
        evaluations: opened evaluation of every run.
        commits: commit of the project, or "" where it is not known -> how many of the runs it judged.
        settings: ``configuration``, names of files; ``cases``, {name: (what it is, methods)}; ``figures``, {name:
            (kind, runs)}; names of ``tables``; runs that have ``explorers``; ``rules``, {name of their file: names}.

    Raises:
        VerdictError: an evaluation holds no verdict.
    """
    runs = sorted((_Run.of(each) for each in evaluations), key=lambda run: (-run.verdict.overall.rank, run.name))
    parts = [
        _verdicts(runs, settings["explorers"]),
        _numbers(runs),
        doubt_table([run.doubt for run in runs]),
        budget_table([run.budget for run in runs]),
        _refuted(runs),
        _cases(settings["cases"]),
        _shown("figures", settings["figures"], FIGURE_FORMATS),
        _shown("tables", {name: ("", []) for name in settings["tables"]}, TABLE_FORMATS),
        _explorers(settings["explorers"]),
        _audit(),
        _rules(settings["rules"]),
    ]
    style = package_files("hypernode.explorer").joinpath("page", "first_page.css").read_text(encoding="utf-8")
    return _HEAD.format(style=style, told=_told(runs, commits, settings), main="\n".join(parts))


def _told(runs, commits: Mapping[str, int], settings) -> str:
    levels = count(run.verdict.overall for run in runs) or "no run is evaluated"
    made = ", ".join(
        f"<code>{escape(commit or 'not known')}</code> ({_counted(n, 'run')})" for commit, n in commits.items()
    )
    names = ", ".join(f"<code>{escape(name)}</code>" for name in settings["configuration"])
    return (
        f"<p>{_counted(len(runs), 'run')} of {_counted(len(settings['cases']), 'case')}: "
        f"<strong>{escape(levels)}</strong>.</p>"
        f"<p>Configuration: {names}. Commit of the project: {made or 'not known'}.</p>"
    )


def _counted(number: int, word: str) -> str:
    return f"{number} {word}" + ("" if number == 1 else "s")


def _link(path: str, words: str) -> str:
    return f'<a href="{escape(path)}">{escape(words)}</a>'


def _reason(verdict: Verdict) -> str:
    return " ".join(verdict.words) or "Every criterion that is judged is met."


def _verdicts(runs, explorers) -> str:
    rows = [
        f'<tr data-level="{run.verdict.overall}"><td class="level">{run.verdict.overall}</td><th scope="row">'
        f"{_link(f'{run.name}/explorer.html', run.name) if run.name in explorers else escape(run.name)}</th>"
        f'<td class="reason">{escape(_reason(run.verdict))}</td></tr>'
        for run in runs
    ]
    caption = "How far each run can be believed by its own numbers, the worst first"
    return "<h2>Verdicts</h2>" + html_table("verdicts", caption, ("verdict", "run", "reasons"), rows)


def _numbers(runs) -> str:
    rows = [
        f'<tr><th scope="row">{escape(run.name)}</th>'
        + "".join(f'<td class="number">{escape(fact(run.summary, key))}</td>' for key in FACTS)
        + "</tr>"
        for run in runs
    ]
    columns = ("run", *(words for words, _ in FACTS.values()))
    return "<h2>Ten numbers</h2>" + html_table("numbers", "Empty where a run does not know it", columns, rows)


def _refuted_map(name: str, evaluation: xr.Dataset) -> str:
    """The cells that the criterion ``refuted`` counts."""
    if "refuted" not in evaluation or not (cells := np.flatnonzero(evaluation["refuted"].values)).size:
        return ""
    (left, low), (right, high) = evaluation["corners"].values
    scale = MAP_SIDE / max(right - left, high - low)
    X = (evaluation["X"].values[evaluation["cells"].values[cells]] - [left, low]) * scale
    height, width = (high - low) * scale, (right - left) * scale
    corners = ([f"{x:.1f},{height - y:.1f}" for x, y in cell] for cell in X)
    path = "".join(f"M{'L'.join(cell)}Z" for cell in corners)
    share = percent(len(cells) / evaluation.sizes["cell"])
    return (
        f'<figure><svg width="{width:.0f}" height="{height:.0f}" role="img" aria-label="{escape(name)}: {share}">'
        '<rect width="100%" height="100%" fill="none" stroke="currentColor"/>'
        f'<path d="{path}" fill="#C00000"/></svg>'
        f"<figcaption>{escape(name)}: {share} of the sheet</figcaption></figure>"
    )


def _refuted(runs: list[_Run]) -> str:
    """A small map of every run whose law is refuted somewhere."""
    maps = "".join(run.refuted for run in runs)
    words = f"What displacements are missed by grows there with the test, by more than {percent(SETTINGS.deformation)}"
    return f"<h2>Where laws fail</h2><p>{words} of the deformation.</p>{maps}" if maps else ""


def _cases(cases: Mapping) -> str:
    rows = [
        f'<tr><th scope="row">{escape(name)}</th><td>{escape(what)}</td><td>{escape(", ".join(methods))}</td></tr>'
        for name, (what, methods) in cases.items()
    ]
    return "<h2>What was run</h2>" + html_table("cases", "Cases and their methods", ("case", "sheet", "methods"), rows)


def _shown(name: str, entries: Mapping, formats: tuple[str, ...]) -> str:
    items = []
    for entry, (kind, runs) in entries.items():
        links = ", ".join(_link(f"{name}/{entry}.{form}", form.upper()) for form in formats)
        about = f": {kind} of {', '.join(runs)}" if kind else ""
        items.append(f"<li>{escape(entry + about)} ({links})</li>")
    return f"<h2>{name.capitalize()}</h2><ul id='{name}'>{''.join(items) or '<li>none</li>'}</ul>"


def _explorers(runs: Iterable[str]) -> str:
    items = "".join(f"<li>{_link(f'{run}/explorer.html', run)}</li>" for run in runs)
    return f"<h2>Explorers</h2><ul id='explorers'>{items or '<li>none</li>'}</ul>"


def _audit() -> str:
    return (
        f"<h2>Audit</h2><p>Every file has a record beside it, and {_link('ro-crate-metadata.json', 'one list of all')} "
        "says what made each from what. <code>hypernode audit verify results</code> checks them, and "
        "<code>hypernode audit explain FILE</code> tells the lineage of one.</p>"
    )


def _rules(rules: Mapping[str, list[str]]) -> str:
    known = [*(topic for topic in TOPICS if topic in rules), *(topic for topic in rules if topic not in TOPICS)]
    boxes = "".join(
        f"<li><h3>{escape(TOPICS.get(topic, topic))}</h3><code>{'</code>, <code>'.join(rules[topic])}</code></li>"
        for topic in known
    )
    return f"<h2>How it was made</h2><p>Rules of the workflow by topic, in order.</p><ol class='topics'>{boxes}</ol>"
