"""What a job is made from besides the results of the stages before it: raw files, references and code."""

from functools import cache
from pathlib import Path

from hypernode.config.model import Config
from hypernode.config.slices import case_geometries
from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.errors import DicError
from hypernode.dic.folder import raw_files
from hypernode.dic.text import without_braces
from hypernode.storage.provenance import code_hash


def code_params(scripts: Path) -> dict[str, str]:
    """Rule -> hash of its script and of the modules that it imports."""
    return {script.stem: code_hash(script) for script in sorted(scripts.glob("*.py"))}


def specimen_files(config: Config, name: str) -> list[str]:
    """Raw files of a specimen: every frame and the force record of each of its tests."""
    specimen = config.specimens[config.cases[name].specimen]
    try:
        tests = [test.model_dump_json(include=set(SpecimenTest.model_fields)) for test in specimen.all_tests]
        files = without_braces(path for test in tests for path in _raw_files(test))
    except DicError as error:
        raise SystemExit(f"The specimen {config.cases[name].specimen} cannot be used.\n{error}") from None
    return list(dict.fromkeys([*files, *([specimen.thickness_map] if specimen.thickness_map else [])]))


@cache
def _raw_files(test: str) -> tuple[str, ...]:
    """Files of a test, given as JSON: every job of a case asks for them, and a folder is looked through once."""
    return tuple(map(str, raw_files(SpecimenTest.model_validate_json(test))))


def image_files(config: Config, name: str) -> list[str]:
    """The images that a synthetic case's geometries are drawn in, if any."""
    geometries = [config.geometries[key] for key in case_geometries(config.cases[name])]
    return [geometry.path for geometry in geometries if geometry.shape == "image"]


def truth_input(config: Config, name: str) -> dict[str, str]:
    """The true material of a synthetic case as a named input."""
    return {} if config.cases[name].specimen else {"truth": f"results/{name}/true_material.nc"}


def printed_input(config: Config, name: str) -> dict[str, str]:
    """The image of a specimen's printed shape as a named input, where it is known."""
    specimen = config.specimens.get(config.cases[name].specimen)
    path = specimen.shape_image if specimen else None
    return {"printed": path} if path and Path(path).is_file() else {}


def reference_inputs(config: Config, name: str) -> dict[str, str]:
    """Measurements of the sheets that consist of one phase of a specimen, by phase, and its own as ``identified``."""
    sheets = {phase: f"results/{case}/measurement.nc" for phase, case in config.cases[name].references.items()}
    return {**sheets, "identified": f"results/{name}/measurement.nc"}
