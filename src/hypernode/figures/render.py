"""From result files to the files of a figure."""

from collections.abc import Mapping

import matplotlib.pyplot as plt

from hypernode.figures import anisotropy, comparison, identification, overview, references
from hypernode.figures.style import RC, save
from hypernode.figures.trust import rows_verdict, run_verdict, write_verdict
from hypernode.storage.netcdf import read

#: Kind of figure -> module with its function ``draw(data, settings)``.
LAYOUTS = {
    "anisotropy": anisotropy,
    "comparison": comparison,
    "identification": identification,
    "overview": overview,
    "references": references,
}


def compose(data: Mapping, settings: dict):
    """The figure, with the verdict on top where a run in it does not pass.

    Args:
        data: opened files by name: ``evaluation``, or ``evaluation0``, ... of a comparison, and what its layout needs.
        settings: ``kind``, and what its layout needs.
    """
    with plt.rc_context(RC):
        figure = LAYOUTS[settings["kind"]].draw(data, settings)
        if settings["kind"] == "comparison":
            evaluations = [data[f"evaluation{index}"] for index in range(len(settings["runs"]))]
            write_verdict(figure, *rows_verdict(evaluations))
        else:
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
