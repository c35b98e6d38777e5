"""What the Snakefile needs to know of a configuration: which cases run, from which files, with which code."""

from pathlib import Path

from hypernode.config import Config, Figure
from hypernode.config_slices import in_fixed_order
from hypernode.dic.davis import DicError, frame_files
from hypernode.storage.provenance import code_hash


def present_cases(config: Config) -> tuple[list[str], list[str]]:
    """(cases that can run, a line for each specimen whose folder is absent)."""
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
    """The image that a synthetic case's geometry is drawn in, if any."""
    geometry = config.geometries[config.cases[name].geometry]
    return [geometry.path] if geometry.shape == "image" else []


def method_settings(config: Config, method: str, keys: tuple[str, ...]) -> dict:
    """The part of a method that one stage uses, so that an edit of another stage does not rerun it."""
    return in_fixed_order(config.methods[method].model_dump(mode="json", include=set(keys)))


def truth_input(config: Config, name: str) -> dict[str, str]:
    """The true material of a synthetic case as a named input."""
    return {} if config.cases[name].specimen else {"truth": f"results/{name}/true_material.nc"}


def figure_runs(config: Config, cases: list[str]) -> dict[str, Figure]:
    """Figures whose case runs."""
    return {name: figure for name, figure in config.figures.items() if figure.case in cases}


def figure_inputs(config: Config, name: str) -> dict[str, str]:
    """Named inputs of a figure."""
    figure = config.figures[name]
    evaluation = f"results/{figure.case}/{figure.method}/evaluation.nc"
    return {"evaluation": evaluation, **truth_input(config, figure.case)}
