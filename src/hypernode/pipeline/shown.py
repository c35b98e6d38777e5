"""What figures, tables and explorers are made from: which runs each of them shows, and the files of those runs."""

import re
from collections.abc import Iterable
from fnmatch import fnmatch
from pathlib import Path

from hypernode.config.model import Config
from hypernode.config.outputs import KINDS_OF_ROWS, Figure
from hypernode.pipeline.dag import field_inputs, run_benchmarks, stage_file
from hypernode.pipeline.sources import reference_inputs, truth_input


def _has_references(config: Config, case: str, present) -> bool:
    needed = config.cases[case].references.values()
    return bool(needed) and all(name in present for name in needed)


def shown_runs(figure: Figure) -> list:
    """The runs that a figure names one by one, each with a ``case`` and, but for pictures, a ``method``."""
    if figure.kind == "detection":
        return []
    return figure.runs if figure.kind in KINDS_OF_ROWS else [figure]


def figure_runs(config: Config, cases: list[str]) -> dict[str, Figure]:
    """Figures all of whose cases run."""
    return {
        name: figure
        for name, figure in config.figures.items()
        if all(run.case in cases for run in shown_runs(figure))
        and (figure.kind != "detection" or matching_runs(config, figure.runs, cases))
        and (figure.kind != "references" or _has_references(config, figure.case, cases))
    }


def matching_runs(config: Config, patterns: list[str], cases) -> list[tuple[str, str]]:
    """(case, method) of every run of some cases that fits one of the patterns."""
    runs = [(case, method) for case in cases for method in config.cases[case].methods]
    return [run for run in runs if any(fnmatch("/".join(run), pattern) for pattern in patterns)]


def figure_inputs(config: Config, name: str) -> dict[str, str]:
    """Named inputs of a figure."""
    figure = config.figures[name]
    if figure.kind == "detection":
        runs = [run for run in matching_runs(config, figure.runs, config.cases) if not config.cases[run[0]].specimen]
        return {f"evaluation{k}": f"results/{'/'.join(run)}/evaluation.nc" for k, run in enumerate(runs)}
    if figure.kind == "comparison":
        files = {f"run{k}": stage_file(config, r.case, r.method, r.stage) for k, r in enumerate(figure.runs)}
        for index, run in enumerate(figure.runs):
            files[f"evaluation{index}"] = f"results/{run.case}/{run.method}/evaluation.nc"
            if not config.cases[run.case].specimen:
                files[f"truth{index}"] = f"results/{run.case}/true_material.nc"
        return files
    if figure.kind == "deformation":
        files = {}
        for index, run in enumerate(figure.runs):
            named = field_inputs(config, run.case, run.method, "field", "measurement")
            named["evaluation"] = f"results/{run.case}/{run.method}/evaluation.nc"
            files |= {f"{key}{index}": file for key, file in named.items()}
        return files
    if figure.kind == "pictures":
        return {key: f"results/{figure.case}/{key}.nc" for key in ("pictures", "correlated", "measurement")}
    folder = f"results/{figure.case}/{figure.method}"
    if figure.kind == "references":
        return {"references": f"{folder}/references.nc", "evaluation": f"{folder}/evaluation.nc"}
    files = {"evaluation": f"{folder}/evaluation.nc", **truth_input(config, figure.case)}
    if figure.kind == "anisotropy":
        files |= field_inputs(config, figure.case, figure.method, "field", "measurement")
        files["material"] = f"{folder}/material.nc"
    if figure.kind == "overview":
        files |= field_inputs(config, figure.case, figure.method, "field", "measurement")
    return files


def explored_runs(config: Config, cases: list[str]) -> dict[tuple[str, str], str | None]:
    """(case, method) of every run with an explorer whose case runs, and the method that is shown beside it."""
    return {(run.case, run.method): run.beside for run in config.explorers if run.case in cases}


def explorer_inputs(config: Config, case: str, method: str, cases: list[str]) -> dict[str, str]:
    """Named inputs of the explorer of a run; those of the one beside it begin with ``beside_``.

    Args:
        cases: the cases that run.
    """
    files = _explored_files(config, case, method)
    if _has_references(config, case, cases):
        files["references"] = f"results/{case}/{method}/references.nc"
        sheets = reference_inputs(config, case)
        files |= {f"sheet_{phase}": file for phase, file in sheets.items() if phase != "identified"}
    # Any run may be asked for; one that is not listed stands alone.
    other = explored_runs(config, cases).get((case, method))
    if other is not None:
        files |= {f"beside_{key}": file for key, file in _explored_files(config, case, other).items()}
    return files


def _explored_files(config: Config, case: str, method: str) -> dict[str, str]:
    return {
        **field_inputs(config, case, method, "measurement", "constrained"),
        **truth_input(config, case),
        **{stage: f"results/{case}/{method}/{stage}.nc" for stage in ("material", "evaluation")},
    }


def table_inputs(config: Config, name: str, cases: list[str]) -> dict[str, list[str]]:
    """Named inputs of a table: ``results`` of its runs and, for one of times, their ``benchmarks``.

    Args:
        cases: the cases that run.
    """
    table = config.tables[name]
    if table.kind == "settings":
        return {}
    chosen = matching_runs(config, table.runs, cases)
    # How a run ended stands in its evaluation, whatever the table shows.
    stages = ["evaluation"]
    if table.kind == "validation":
        stages, chosen = ["validation", *stages], [run for run in chosen if config.cases[run[0]].unseen_loads]
    if table.kind == "references":
        stages, chosen = ["references", *stages], [run for run in chosen if _has_references(config, run[0], cases)]
    inputs = {"results": [f"results/{case}/{method}/{stage}.nc" for case, method in chosen for stage in stages]}
    if table.kind == "timing":
        inputs["benchmarks"] = list(dict.fromkeys(file for run in chosen for file in run_benchmarks(config, *run)))
    return inputs


def table_settings(config: Config, name: str) -> dict:
    """What the script that writes a table needs."""
    table = config.tables[name]
    if table.kind == "settings":
        entries = {key: entry.model_dump(mode="json") for key, entry in getattr(config, table.section).items()}
        return {"kind": "settings", "entries": entries}
    return {"kind": table.kind, "columns": table.columns, "groups": table.groups}


def rules_by_topic(files: Iterable[Path]) -> dict[str, list[str]]:
    """Name of every file of rules among some files -> names of its rules."""
    return {
        file.stem: re.findall(r"^(?:use rule \w+ as|rule) (\w+)\b", file.read_text(encoding="utf-8"), re.MULTILINE)
        for file in files
        if file.suffix == ".smk"
    }


def first_page_settings(config: Config, cases: list[str], files: list[str], rules: dict[str, list[str]]) -> dict:
    """What the first page of the results says beside what their evaluations do.

    Args:
        cases: the cases that run.
        files: names of the files of the configuration.
        rules: as of :func:`rules_by_topic`.
    """
    figures = {
        name: (figure.kind, list(dict.fromkeys(run for shown in shown_runs(figure) for run in _names(config, shown))))
        for name, figure in figure_runs(config, cases).items()
    }
    return {
        "configuration": files,
        "cases": {name: (_in_words(config, name), list(config.cases[name].methods)) for name in cases},
        "figures": figures,
        "tables": list(config.tables),
        "explorers": ["/".join(run) for run in explored_runs(config, cases)],
        "rules": rules,
    }


def _names(config: Config, shown) -> list[str]:
    """``case/method`` of what a figure shows; of pictures, of every run that they are the data of."""
    methods = [shown.method] if hasattr(shown, "method") else config.cases[shown.case].methods
    return [f"{shown.case}/{method}" for method in methods]


def _in_words(config: Config, name: str) -> str:
    """What the sheet of a case is, and what it is put through."""
    case = config.cases[name]
    if case.specimen:
        return f"specimen {case.specimen}"
    drawn = f"{case.inclusion} in {case.matrix} ({case.geometry})" if case.inclusion else case.matrix
    return f"{drawn}, {', '.join(case.loads) or 'no load'}" + (f", noise {case.noise}" if case.noise else "")
