"""Points followed through pictures: by an engine for correlation in its own environment, or as nodes of a mesh."""

import json
import os
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float, Int, UInt

from hypernode.config.correlation import Correlation
from hypernode.installation import repository
from hypernode.pictures.errors import EngineMissing, PictureError
from hypernode.pictures.finite_elements import Seen, seen_by_elements

#: Engine -> (variable of the environment that names its Python, folder that the Makefile makes, its target).
PYTHONS = {
    "pyvale": ("HYPERNODE_PYVALE", ".venv-pyvale", "pyvale-env"),
    "al_dic": ("HYPERNODE_AL_DIC", ".venv-al-dic", "al-dic-env"),
}
_SCRIPTS = Path(__file__).with_name("engines")
#: Lines that are shown of the error with which an engine ended.
_LINES = 3


@dataclass(frozen=True, kw_only=True)
class Correlated:
    """Points of the first picture in all others.

    Attributes:
        column, row: pixel of each point in the first picture, on a square grid.
        displacement: in pixels, columns to the right and rows down; 0 in the first frame, NaN where a point is lost.
        correlation: zero-normalised cross-correlation of what was compared, 1 at best; NaN where a point is lost.
        step: distance of the points [pixel].
    """

    column: Int[np.ndarray, " point"]
    row: Int[np.ndarray, " point"]
    displacement: Float[np.ndarray, "frame point 2"]
    correlation: Float[np.ndarray, "frame point"]
    step: int

    def to_dataset(self) -> xr.Dataset:
        """Variables as they are stored."""
        return xr.Dataset(
            {
                "pixel_column": ("pixel_point", self.column),
                "pixel_row": ("pixel_point", self.row),
                "pixel_displacement": (("frame", "pixel_point", "component"), self.displacement),
                "correlation": (("frame", "pixel_point"), self.correlation),
            },
            attrs={"correlation_step": self.step},
        )

    @classmethod
    def of_nodes(cls, seen: Seen, step: int) -> "Correlated":
        """The nodes of finite elements as points."""
        column, row = np.round(seen.mesh.nodes).astype(int).T
        return cls(
            column=column,
            row=row,
            displacement=np.concatenate([np.zeros((1, *seen.u.shape[1:])), seen.u]),
            correlation=np.concatenate([np.ones((1, len(column))), seen.correlation]),
            step=step,
        )

    @classmethod
    def from_dataset(cls, dataset: xr.Dataset) -> "Correlated":
        """What :meth:`to_dataset` made a dataset of."""
        return cls(
            column=dataset["pixel_column"].values,
            row=dataset["pixel_row"].values,
            displacement=dataset["pixel_displacement"].values,
            correlation=dataset["correlation"].values,
            step=int(dataset.attrs["correlation_step"]),
        )


def python_of(engine: str) -> Path:
    """The Python of an engine: the one that the environment names, or that of the repository's folder.

    Raises:
        EngineMissing: there is none.
    """
    variable, folder, target = PYTHONS[engine]
    named = os.environ.get(variable)
    base = repository()
    if not named and base is None:
        raise EngineMissing(f"the correlation engine {engine} needs a Python that {variable} names; none is named")
    path = Path(named) if named else base / folder / "bin" / "python"
    if not path.is_file():
        raise EngineMissing(
            f"the correlation engine {engine} is not installed: {path} is not there; `make {target}` makes it, "
            f"or {variable} names another Python"
        )
    return path


def correlate(
    pictures: UInt[np.ndarray, "frame row column"],
    mask: Bool[np.ndarray, "row column"],
    settings: Correlation,
    threads: int = 1,
) -> Correlated:
    """Follow points on a square grid through pictures.

    Args:
        pictures: grey values of 8 or 16 bit; the first is the reference.
        mask: where there is something to follow; subsets lie within it.
        threads: processor threads the engine may use; the result does not depend on them.

    Raises:
        EngineMissing: the engine's environment is not there.
        PictureError: pictures and mask do not fit, or the engine gave up.
    """
    if settings.engine == "finite_elements":
        check(pictures, mask, settings)
        return Correlated.of_nodes(seen_by_elements(pictures, mask, settings.step), settings.step)
    python = python_of(settings.engine)
    check(pictures, mask, settings)
    asked = settings.model_dump(mode="json") | {"threads": threads}
    with tempfile.TemporaryDirectory(prefix="hypernode-") as name:
        folder = Path(name)
        np.save(folder / "pictures.npy", pictures)
        np.save(folder / "mask.npy", mask)
        (folder / "settings.json").write_text(json.dumps(asked))
        _execute(python, settings.engine, folder, threads)
        with np.load(folder / "correlated.npz") as found:
            column, row, displacement, correlation = (
                found[key] for key in ("column", "row", "displacement", "correlation")
            )
    lost = ~np.isfinite(displacement).all(-1)
    displacement = np.where(lost[..., None], np.nan, displacement)
    correlation = np.where(lost, np.nan, correlation)
    first = np.zeros((1, *displacement.shape[1:])), np.ones((1, len(column)))
    return Correlated(
        column=column.astype(int),
        row=row.astype(int),
        displacement=np.concatenate([first[0], displacement]),
        correlation=np.concatenate([first[1], correlation]),
        step=settings.step,
    )


def check(pictures, mask, settings: Correlation) -> None:
    """Refuse pictures and a mask that do not fit.

    Raises:
        PictureError: with what is wrong.
    """
    if pictures.ndim != 3 or len(pictures) < 2 or pictures.dtype not in (np.uint8, np.uint16):
        raise PictureError(
            f"pictures must be two or more of one size with grey values of 8 or 16 bit, not {pictures.dtype} "
            f"{pictures.shape}"
        )
    if mask.shape != pictures.shape[1:]:
        raise PictureError(f"the mask has {mask.shape} rows and columns, the pictures have {pictures.shape[1:]}")
    least = min(mask.shape)
    if settings.engine in PYTHONS and settings.reach * 2 >= least:
        raise PictureError(
            f"reach = {settings.reach} pixels must be less than half of the pictures' shorter side, {least} pixels"
        )
    if not mask.any():
        raise PictureError("the mask leaves no pixel to follow")


def _execute(python: Path, engine: str, folder: Path, threads: int) -> None:
    """Run an engine's script on a folder.

    Raises:
        PictureError: it ended with an error, which is quoted.
    """
    script = _SCRIPTS / f"with_{engine}.py"
    environment = os.environ | {"OMP_NUM_THREADS": str(threads), "NUMBA_NUM_THREADS": str(threads)}
    # The package's own folder must not stand before the engine's packages.
    environment.pop("PYTHONPATH", None)
    done = subprocess.run(  # noqa: S603
        [python, script, folder], capture_output=True, text=True, env=environment, check=False, cwd=folder
    )
    if done.returncode != 0 or not (folder / "correlated.npz").is_file():
        raise PictureError(
            f"the correlation engine {engine} ended with code {done.returncode}: "
            f"{_complaint(done.stderr or done.stdout) or 'no word'}"
        )


def _complaint(said: str) -> str:
    """What an engine said from its last line with an error on, or its last line."""
    lines = said.strip().splitlines()
    last = max((k for k, line in enumerate(lines) if "Error" in line), default=len(lines) - 1)
    return ", ".join(line.strip() for line in lines[last : last + _LINES])
