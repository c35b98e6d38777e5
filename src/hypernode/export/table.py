"""The laws of the phases as a table that a person can type into any code."""

import csv
import io

from hypernode.export.choice import Candidate, candidates
from hypernode.export.curves import Curves, curves_of
from hypernode.export.run import Run

#: Misfit of the stress beyond which no candidate follows a phase.
FOLLOWS = 0.05
HEADER = ("phase", "rank", "law", "parameter", "value", "standard_deviation", "unit", "misfit", "criterion")


def phase_laws(run: Run) -> list[tuple[Curves, list[Candidate]]]:
    """The curves of every phase and the laws fitted to them, the best first."""
    curves = curves_of(run)
    return list(zip(curves, candidates(curves), strict=True))


def table_files(run: Run, laws: list[tuple[Curves, list[Candidate]]]) -> dict[str, bytes]:
    """{name: content} of ``laws.md`` and ``laws.csv``."""
    return {"laws.md": _page(run, laws).encode(), "laws.csv": _csv(run, laws).encode()}


def parameter_rows(run: Run, candidate: Candidate) -> list[tuple[str, float, float, str]]:
    """(name, value, standard deviation, unit) of every parameter."""
    unit = run.material.units["stress"]
    return [
        (parameter.name, float(value), float(deviation), unit if parameter.stress else parameter.unit)
        for parameter, value, deviation in zip(
            candidate.law.parameters, candidate.params, candidate.deviation, strict=True
        )
    ]


def _csv(run: Run, laws) -> str:
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(HEADER)
    for curves, found in laws:
        for rank, each in enumerate(found):
            for name, value, deviation, unit in parameter_rows(run, each):
                rows.writerow(
                    (curves.phase, rank, each.law.name, name, value, deviation, unit, each.misfit, each.criterion)
                )
    return text.getvalue()


def _page(run: Run, laws) -> str:
    lines = [
        f"# Laws of the phases, {run.name}",
        "",
        f"Energy by reference volume, stresses in {run.material.units['stress']}; invariants of the incompressible "
        "solid where the formula says nothing else, I4 the squared stretch along the fibres, <E> positive or zero.",
        f"Verdict on the run: {run.verdict.label}. " + _deviations(run),
    ]
    for curves, found in laws:
        lines += ["", *_phase(run, curves, found)]
    return "\n".join([*lines, ""])


def _deviations(run: Run) -> str:
    if run.samples:
        return (
            "Standard deviations are those of fits to the posterior samples: what the test leaves open. What a law "
            "misses stands beside them as its misfit."
        )
    return "There are no posterior samples: standard deviations are those of the fit to stresses sure to 1 %."


def _phase(run: Run, curves: Curves, found: list[Candidate]) -> list[str]:
    best, modes = found[0], ", ".join(dict.fromkeys(curves.modes))
    lines = [
        f"## Phase {curves.phase}: {best.law.name}",
        "",
        f"{len(curves.cells)} cells, {100.0 * curves.share:.1f} % of the sheet; fitted to {modes}, up to a principal "
        f"stretch of {curves.largest_stretch:.4g}.",
        "",
        f"W = {best.law.formula}",
        "",
        "| parameter | value | standard deviation | unit |",
        "|---|---:|---:|---|",
        *(
            f"| {name} | {value:.4g} | {deviation:.2g} | {unit} |"
            for name, value, deviation, unit in parameter_rows(run, best)
        ),
        "",
        "| law | misfit of the stress | criterion above the best |",
        "|---|---:|---:|",
        *(
            f"| {each.law.name} | {100.0 * each.misfit:.2g} % | {each.criterion - best.criterion:.1f} |"
            for each in found
        ),
    ]
    if best.misfit > FOLLOWS:
        lines += [
            "",
            f"No law of these follows this phase: even the best misses {100.0 * best.misfit:.2g} % of its stress.",
        ]
    return lines
