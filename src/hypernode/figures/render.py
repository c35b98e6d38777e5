"""From result files to the files of a figure."""

from collections.abc import Mapping

import matplotlib.pyplot as plt

from hypernode.figures import (
    anisotropy,
    comparison,
    deformation,
    detection,
    identification,
    overview,
    pictures,
    references,
)
from hypernode.figures.style import RC, save
from hypernode.figures.trust import run_verdict, runs_verdict, write_verdict
from hypernode.storage.netcdf import read

#: Kind of figure -> module with its function ``draw(data, settings)``.
LAYOUTS = {
    "anisotropy": anisotropy,
    "comparison": comparison,
    "deformation": deformation,
    "detection": detection,
    "identification": identification,
    "overview": overview,
    "pictures": pictures,
    "references": references,
}

#: Kinds of figures of several runs -> what they show of each.
SEVERAL = {"comparison": "rows", "deformation": "rows", "detection": "runs in this figure"}
#: Kinds of figures of a measurement, of which no verdict is known.
MEASURED = ("pictures",)


def compose(data: Mapping, settings: dict):
    """The figure, with the verdict on top where a run in it does not pass.

    Args:
        data: opened files by name: ``evaluation``, or ``evaluation0``, ... of a comparison, and what its layout needs.
        settings: ``kind``, and what its layout needs.
    """
    with plt.rc_context(RC):
        figure = LAYOUTS[settings["kind"]].draw(data, settings)
        if settings["kind"] in SEVERAL:
            evaluations = [file for name, file in data.items() if name.startswith("evaluation")]
            write_verdict(figure, *runs_verdict(evaluations, SEVERAL[settings["kind"]]))
        elif settings["kind"] not in MEASURED:
            write_verdict(figure, *run_verdict(data["evaluation"]))
    return figure


def render(inputs: Mapping[str, str], files: Mapping[str, str], settings: dict, provenance: dict) -> None:
    """Draw a figure and write it in every format.

    Args:
        inputs: name -> path of a result file.
        files: format -> path.
        settings: see :func:`compose`.
        provenance: what the job says of itself.

    Raises:
        StorageError: a file is missing or damaged, or the disk refuses.
    """
    opened = {path: read(path) for path in dict.fromkeys(inputs.values())}
    figure = compose({name: opened[path] for name, path in inputs.items()}, settings)
    save(figure, files, provenance, opened)
