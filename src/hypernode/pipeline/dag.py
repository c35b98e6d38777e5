"""What the Snakefile needs to know of a configuration: which cases run, from which files, with which code."""

from fnmatch import fnmatch
from pathlib import Path

from hypernode.config.model import Config
from hypernode.config.outputs import Figure
from hypernode.config.slices import case_geometries, in_fixed_order
from hypernode.dic.davis import frame_files
from hypernode.dic.errors import DicError
from hypernode.storage.provenance import code_hash


def present_cases(config: Config) -> tuple[list[str], list[str]]:
    """(cases that can run, a line for each that cannot, since its specimen is optional and has no folder here)."""
    present, absent = [], []
    for name, case in config.cases.items():
        specimen = config.specimens.get(case.specimen) if case.specimen else None
        if specimen is not None and not Path(specimen.folder).is_dir():
            source = f"; its data are published in {specimen.published_at}" if specimen.published_at else ""
            absent.append(f"Leaving out {name}: there is no folder {specimen.folder}{source}")
        else:
            present.append(name)
    return present, absent


def code_params(scripts: Path) -> dict[str, str]:
    """Rule -> hash of its script and of the modules that it imports."""
    return {script.stem: code_hash(script) for script in sorted(scripts.glob("*.py"))}


def specimen_files(config: Config, name: str) -> list[str]:
    """Raw files of a specimen: every frame and the force record."""
    specimen = config.specimens[config.cases[name].specimen]
    folder = Path(specimen.folder)
    try:
        frames = frame_files(folder)
    except DicError as error:
        raise SystemExit(f"The specimen {config.cases[name].specimen} cannot be used.\n{error}") from None
    return [*map(str, frames.values()), str(folder / specimen.force_file)]


def image_files(config: Config, name: str) -> list[str]:
    """The images that a synthetic case's geometries are drawn in, if any."""
    geometries = [config.geometries[key] for key in case_geometries(config.cases[name])]
    return [geometry.path for geometry in geometries if geometry.shape == "image"]


#: Stage -> the parts of a method that it uses, in the order in which the stages follow one another. The first part
#: of the list, to ``pretrained``, is a chain; ``material`` and ``baseline`` are its two ends.
STAGE_SETTINGS = {
    "constrained": ("constrained",),
    "gradient": ("gradient",),
    "interpolant": ("interpolant", "seed"),
    "homogenised": ("node", "homogenised", "seed"),
    "initialised": ("hypernetwork", "initialisation", "seed"),
    "pretrained": ("hypernetwork", "pretraining", "prior_weight", "seed"),
    "material": ("hypernetwork", "training", "prior_weight", "seed"),
    "baseline": ("baseline", "seed"),
}
#: The stages that train the hyper-network, in their order, and the section of a method with their iterations.
NETWORK_STAGES = {"initialised": "initialisation", "pretrained": "pretraining", "material": "training"}
#: Stages whose file methods share where all that decides it is the same.
SHARED = tuple(STAGE_SETTINGS)[: tuple(STAGE_SETTINGS).index("pretrained") + 1]


def method_settings(config: Config, method: str, stage: str) -> dict:
    """The part of a method that one stage uses, so that an edit of another stage does not rerun it."""
    return in_fixed_order(config.methods[method].model_dump(mode="json", include=set(STAGE_SETTINGS[stage])))


def stage_file(config: Config, case: str, method: str, stage: str) -> str:
    """The result of one stage: that of the case's first method for which it is the same.

    Methods that differ only in later stages share the earlier ones, which are computed once.
    """
    if stage in SHARED:
        keys = {key for earlier in SHARED[: SHARED.index(stage) + 1] for key in STAGE_SETTINGS[earlier]}
        wanted = [getattr(config.methods[method], key) for key in keys]
        same = [m for m in config.cases[case].methods if [getattr(config.methods[m], key) for key in keys] == wanted]
        method = next(iter(same), method)
    if stage == "pretrained" and only_pretrained(config, method):
        stage = "material"
    return f"results/{case}/{method}/{stage}.nc"


def only_pretrained(config: Config, method: str) -> bool:
    """Whether the hyper-network that pre-training leaves is the method's result."""
    settings = config.methods[method]
    return bool(settings.pretraining and settings.pretraining.iterations and not settings.training.iterations)


def previous_input(config: Config, case: str, method: str, stage: str) -> dict[str, str]:
    """The hyper-network that a stage goes on with, as a named input.

    It is that of the last stage before it that has iterations; where none has, there is none.
    """
    stages = list(NETWORK_STAGES)
    for earlier in reversed(stages[: stages.index(stage)]):
        if getattr(config.methods[method], NETWORK_STAGES[earlier]).iterations:
            return {"previous": stage_file(config, case, method, earlier)}
    return {}


def field_inputs(config: Config, case: str, method: str, *keys: str) -> dict[str, str]:
    """Named inputs of a stage that learns from the deformation field.

    ``field`` is the interpolant, or the gradient where the method has no interpolant; ``constrained``
    is left out where the method has no constrained field.
    """
    settings = config.methods[method]
    stages = {
        "field": "gradient" if settings.interpolant is None else "interpolant",
        "homogenised": "homogenised",
    }
    if settings.constrained is not None:
        stages["constrained"] = "constrained"
    files = {key: stage_file(config, case, method, stage) for key, stage in stages.items()}
    files["measurement"] = f"results/{case}/measurement.nc"
    return {key: files[key] for key in keys if key in files}


def truth_input(config: Config, name: str) -> dict[str, str]:
    """The true material of a synthetic case as a named input."""
    return {} if config.cases[name].specimen else {"truth": f"results/{name}/true_material.nc"}


def printed_input(config: Config, name: str) -> dict[str, str]:
    """The image of a specimen's printed shape as a named input, where it is known."""
    specimen = config.specimens.get(config.cases[name].specimen)
    path = specimen.shape_image if specimen else None
    return {"printed": path} if path and Path(path).is_file() else {}


def reference_inputs(config: Config, name: str) -> dict[str, str]:
    """Measurements of the sheets that consist of one phase of a specimen, by phase."""
    return {phase: f"results/{case}/measurement.nc" for phase, case in config.cases[name].references.items()}


def _has_references(config: Config, case: str, present) -> bool:
    needed = config.cases[case].references.values()
    return bool(needed) and all(name in present for name in needed)


def shown_runs(figure: Figure) -> list:
    """The runs that a figure shows, each with a ``case`` and a ``method``."""
    return figure.runs if figure.kind == "comparison" else [figure]


def figure_runs(config: Config, cases: list[str]) -> dict[str, Figure]:
    """Figures all of whose cases run."""
    return {
        name: figure
        for name, figure in config.figures.items()
        if all(run.case in cases for run in shown_runs(figure))
        and (figure.kind != "references" or _has_references(config, figure.case, cases))
    }


def figure_inputs(config: Config, name: str) -> dict[str, str]:
    """Named inputs of a figure."""
    figure = config.figures[name]
    if figure.kind == "comparison":
        files = {f"run{k}": stage_file(config, r.case, r.method, r.stage) for k, r in enumerate(figure.runs)}
        for index, run in enumerate(figure.runs):
            if not config.cases[run.case].specimen:
                files[f"truth{index}"] = f"results/{run.case}/true_material.nc"
        return files
    folder = f"results/{figure.case}/{figure.method}"
    if figure.kind == "references":
        return {"references": f"{folder}/references.nc"}
    files = {"evaluation": f"{folder}/evaluation.nc", **truth_input(config, figure.case)}
    if figure.kind == "anisotropy":
        files["material"] = f"{folder}/material.nc"
    if figure.kind == "overview":
        files["measurement"] = f"results/{figure.case}/measurement.nc"
    return files


def table_inputs(config: Config, name: str, runs: list[tuple[str, str]], cases: list[str]) -> list[str]:
    """Evaluation files of the runs in a table, of ``runs`` that there are; ``cases`` are those that are present."""
    table = config.tables[name]
    if table.kind == "settings":
        return []
    chosen = [run for run in runs if any(fnmatch("/".join(run), pattern) for pattern in table.runs)]
    stage = "evaluation"
    if table.kind == "validation":
        stage, chosen = "validation", [run for run in chosen if config.cases[run[0]].unseen_loads]
    if table.kind == "references":
        stage, chosen = "references", [run for run in chosen if _has_references(config, run[0], cases)]
    return [f"results/{case}/{method}/{stage}.nc" for case, method in chosen]


def table_settings(config: Config, name: str) -> dict:
    """What the script that writes a table needs."""
    table = config.tables[name]
    if table.kind == "settings":
        entries = {key: entry.model_dump(mode="json") for key, entry in getattr(config, table.section).items()}
        return {"kind": "settings", "entries": entries}
    return {"kind": table.kind, "columns": table.columns, "groups": table.groups}
