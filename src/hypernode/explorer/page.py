"""The page: everything that is shown, and what shows it, in one file."""

import json
from collections.abc import Mapping
from importlib.resources import files as package_files

import matplotlib
import numpy as np
import xarray as xr

from hypernode.explorer.errors import ExplorerError
from hypernode.explorer.packing import Arrays
from hypernode.explorer.run import packed_run
from hypernode.figures.style import ANGLE_MAP, ERROR_MAP, FIELD_MAP, STRAIN_MAP

#: Bytes beyond which a page is refused: it must go by mail and open at once.
LARGEST = 5_000_000
#: Parts of the script in the order in which they use one another.
SCRIPT = (
    *("data", "mechanics", "colours", "cells", "sheet", "chart", "view", "curves", "words", "export"),
    "controls",
)
#: Samples of a colour map, between which the page interpolates: the error is below what eight bits tell apart.
SAMPLES = 33


def explorer_page(first: Mapping[str, xr.Dataset], second: Mapping[str, xr.Dataset] | None = None) -> str:
    """The HTML text of an explorer.

    Args:
        first: opened files of a run, as of :func:`~hypernode.explorer.run.packed_run`.
        second: those of a run that is shown beside it.

    Raises:
        ExplorerError: the runs have other units, a law has no text, or the page would be too large.
        VerdictError: an evaluation holds no verdict.
    """
    arrays = Arrays()
    runs = [packed_run(each, arrays) for each in (first, second) if each is not None]
    if any(run["units"] != runs[0]["units"] for run in runs):
        raise ExplorerError("the two runs have other units and cannot be compared: name runs of one specimen")
    laws = _numbered_laws(runs)
    colours = {name: _samples(name) for name in (FIELD_MAP, STRAIN_MAP, ERROR_MAP, ANGLE_MAP)}
    # A "<" in a name must not end the element in which it stands.
    data = json.dumps({"runs": runs, "colours": colours}, separators=(",", ":"), allow_nan=False).replace(
        "<", "\\u003c"
    )
    functions = "const {abs,cos,cosh,exp,expm1,log,log1p,max,min,pow,sin,sinh,sqrt,tan,tanh}=Math;"
    script = "\n".join([functions, *(_part(f"{name}.js") for name in SCRIPT)])
    text = _part("index.html")
    for name, content in {
        "title": " beside ".join(run["name"] for run in runs),
        "style": _part("style.css"),
        "drawing": _part("drawing.css"),
        "script": f"{script}\nconst LAWS=[{','.join(laws)}];",
        "data": data,
        "arrays": arrays.text,
    }.items():
        text = text.replace(f"{{{{{name}}}}}", content)
    if len(text.encode()) > LARGEST:
        raise ExplorerError(
            f"the page would take {len(text.encode()) / 1e6:.1f} MB, more than {LARGEST / 1e6:.0f}: "
            + ("name one run alone" if second is not None else "the grid is too fine to be explored")
        )
    return text


def _part(name: str) -> str:
    return package_files("hypernode.explorer").joinpath("page", name).read_text(encoding="utf-8")


def _numbered_laws(runs: list[dict]) -> list[str]:
    """The laws of all materials, each once; in their place, the runs get the number."""
    laws: dict[str, int] = {}
    for run in runs:
        for material in filter(None, (run[key] for key in ("identified", "truth", "posterior"))):
            material["law"] = laws.setdefault(material["law"], len(laws))
    return list(laws)


def _samples(name: str) -> list[list[int]]:
    colours = matplotlib.colormaps[name](np.linspace(0.0, 1.0, SAMPLES))[:, :3]
    return np.rint(255.0 * colours).astype(int).tolist()
