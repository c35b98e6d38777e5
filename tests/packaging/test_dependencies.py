"""What is declared, what is pinned and what is imported agree."""

import ast
import re
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from hypernode.installation import EXTRAS, needs

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
BASE = {each.name: each.specifier for each in map(Requirement, PROJECT["dependencies"])}
OPTIONAL = {
    extra: {each.name: each.specifier for each in map(Requirement, given)}
    for extra, given in PROJECT["optional-dependencies"].items()
}
#: Module -> distribution, where they have other names.
DISTRIBUTIONS = {
    "PIL": "pillow",
    "skimage": "scikit-image",
    "basix": "fenics-basix",
    "jax_fem": "jax-fem",
    "ruamel": "ruamel.yaml",
    "al_dic": "al-dic",
}


def pins(file):
    return dict(re.findall(r"^([\w.-]+)==(\S+)$", (ROOT / file).read_text(), re.MULTILINE))


def test_every_pin_of_the_pipeline_is_a_version_that_the_package_allows():
    ranges = BASE | OPTIONAL["pipeline"]
    pinned = pins("requirements.txt")
    assert set(pinned) == set(ranges)
    assert not [name for name, version in pinned.items() if version not in ranges[name]]
    assert not [
        name for name, version in pins("requirements/ncorr.txt").items() if version not in OPTIONAL["ncorr"][name]
    ]


def test_the_plugin_for_a_gpu_is_of_the_version_of_jax():
    text = (ROOT / "requirements/gpu.txt").read_text()
    plugins = dict(re.findall(r"^(jax-cuda12-\w+)(?:\[[\w-]+\])?==(\S+)$", text, re.MULTILINE))
    assert set(plugins) == {"jax-cuda12-plugin", "jax-cuda12-pjrt"}
    assert set(plugins.values()) == {pins("requirements.txt")["jax"]} == {pins("requirements.txt")["jaxlib"]}
    assert "-r ../requirements.txt" in text and "-c constraints.txt" in text


def test_the_compiler_that_sums_wrongly_is_refused():
    assert "0.10.2" not in BASE["jax"] and "0.10.2" not in BASE["jaxlib"]


#: Scripts that other environments execute.
ENGINES = ROOT / "src" / "hypernode" / "pictures" / "engines"


def imported(folder):
    """Module at the top -> files that import it, anywhere in them."""
    found = {}
    for path in [path for path in folder.rglob("*.py") if folder == ENGINES or ENGINES not in path.parents]:
        for node in ast.walk(ast.parse(path.read_text())):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names = [node.module]
            for name in names:
                found.setdefault(name.split(".")[0], set()).add(path.name)
    return {name: files for name, files in found.items() if name not in {*sys.stdlib_module_names, "hypernode"}}


def test_what_is_imported_is_declared_and_what_an_extra_brings_is_named():
    modules = imported(ROOT / "src") | imported(ROOT / "workflow")
    declared = {name: "" for name in BASE} | {name: extra for extra, given in OPTIONAL.items() for name in given}
    extra_of = {module: declared.get(DISTRIBUTIONS.get(module, module)) for module in modules}
    assert not [module for module, extra in extra_of.items() if extra is None]
    assert {module: extra for module, extra in extra_of.items() if extra} == {
        module: EXTRAS.get(module) for module, extra in extra_of.items() if extra
    }
    assert {DISTRIBUTIONS.get(module, module): extra for module, extra in EXTRAS.items()} == {
        name: extra for name, extra in declared.items() if extra
    }


def test_what_scripts_of_correlation_engines_import_is_pinned_in_their_environments():
    for script in ENGINES.glob("with_*.py"):
        there = pins(f"requirements/{script.stem.removeprefix('with_').replace('_', '-')}.txt")
        top = {
            name.split(".")[0]
            for node in ast.walk(ast.parse(script.read_text()))
            for name in ([each.name for each in node.names] if isinstance(node, ast.Import) else [])
            + ([node.module] if isinstance(node, ast.ImportFrom) else [])
        }
        own = top - {*sys.stdlib_module_names}
        assert own and {DISTRIBUTIONS.get(name, name) for name in own} <= set(there), script.name


@pytest.mark.parametrize("module", ["matplotlib.pyplot", "h5py", "json"])
def test_a_missing_module_is_answered_with_the_extra_that_brings_it(module):
    sentence = {"matplotlib.pyplot": "pipeline", "h5py": "ncorr"}.get(module)
    assert needs(module) == (
        sentence
        and f'{module} is not installed: it comes with the extra {sentence}, pip install "hypernode[{sentence}]"'
    )
