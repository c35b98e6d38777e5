"""What is installed beside the package: the workflow's files, and the extras that commands may lack."""

import importlib.metadata
from pathlib import Path

_ABOVE = Path(__file__).resolve().parents[2]
#: Where a wheel puts the workflow, below the folder for data of the installation (pyproject.toml).
_SHARE = ("share", "hypernode")
#: Module that not every installation has -> the extra that brings it.
EXTRAS = {
    **dict.fromkeys(("snakemake", "jax_fem", "basix", "meshio", "pyfiglet", "optax"), "pipeline"),
    **dict.fromkeys(("matplotlib", "skimage", "PIL", "rocrate", "pygments"), "pipeline"),
    "h5py": "ncorr",
}


def repository() -> Path | None:
    """The project's repository, where the package is imported from it."""
    return _ABOVE if (_ABOVE / "Snakefile").is_file() and (_ABOVE / "pyproject.toml").is_file() else None


def project_folder() -> Path | None:
    """Folder of the Snakefile, its rules, profiles and pinned requirements: the repository, or what a wheel brought."""
    if found := repository():
        return found
    try:
        files = importlib.metadata.files("hypernode") or []
    except importlib.metadata.PackageNotFoundError:
        return None
    brought = [Path(file.locate()) for file in files if file.parts[-3:] == (*_SHARE, "Snakefile")]
    return next((path.resolve().parent for path in brought if path.is_file()), None)


def needs(module: str) -> str | None:
    """One sentence on which extra brings a module that is not installed, or None where no extra does."""
    extra = EXTRAS.get(module.split(".")[0])
    return extra and f'{module} is not installed: it comes with the extra {extra}, pip install "hypernode[{extra}]"'
