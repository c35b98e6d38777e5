"""``hypernode predict``: forces and displacements of another sheet from laws that are identified, with no refit."""

import json
from pathlib import Path

from hypernode.commands.options import UsageError
from hypernode.mechanics.loads import CONSTRAINED

#: Loads that a sheet without a test can be given.
LOADS = tuple(kind for kind in CONSTRAINED if kind not in ("general", "biaxial"))


def add_predict(commands) -> None:
    """``predict [MEASUREMENT]``."""
    parser = commands.add_parser(
        "predict", help="predict forces and displacements of another sheet of the same phases, without identifying it"
    )
    parser.add_argument(
        "measurement", type=Path, nargs="?", metavar="MEASUREMENT", help="its results/CASE/measurement.nc; none: --size"
    )
    parser.add_argument(
        "--laws",
        nargs="+",
        required=True,
        metavar="RUN[:PHASE][+RUN[:PHASE]]",
        help="runs whose phases are the sheet's, the softest first: all phases of a run, or the one whose number is "
        "given, from 1; runs joined by + are pooled",
    )
    shape = parser.add_mutually_exclusive_group()
    shape.add_argument(
        "--shape", type=Path, metavar="PICTURE", help="grey levels are phases, the darkest of the softest law"
    )
    shape.add_argument("--lines", type=Path, metavar="RUN", help="an identification of the same sheet, for its lines")
    parser.add_argument("--flipped", action="store_true", help="the first row of the picture is at the bottom")
    parser.add_argument("--size", type=float, nargs=3, metavar=("WIDTH", "HEIGHT", "THICKNESS"), help="[mm]")
    parser.add_argument("--load", choices=LOADS, default="clamped_y", metavar="KIND", help=", ".join(LOADS))
    parser.add_argument("--stretches", type=float, nargs="+", metavar="S", help="load steps of a sheet without a test")
    parser.add_argument(
        "--output", type=Path, default=Path("prediction.nc"), metavar="FILE", help="what is written (prediction.nc)"
    )
    parser.add_argument(
        "--figure", type=Path, action="append", default=[], metavar="FILE", help="a figure, .pdf or .png"
    )
    parser.add_argument("--json", action="store_true", help="for machines")
    parser.set_defaults(run=run_predict)


def run_predict(arguments) -> int:
    """Predict, write, and print how far the prediction is from the test.

    Raises:
        UsageError: options that contradict each other.
        PredictionError, StorageError: something is missing; see :func:`hypernode.stages.prediction.run`.
    """
    _check(arguments)
    from hypernode.pipeline.compiler import set_up_compiler

    set_up_compiler(float64=True)
    from hypernode.figures.prediction import write
    from hypernode.mechanics.loads import make_load
    from hypernode.stages.prediction import LawFrom, Target, run
    from hypernode.storage.netcdf import read

    load = None if arguments.measurement else make_load(arguments.load, arguments.stretches)
    size = tuple(arguments.size) if arguments.size else None
    target = Target(
        measurement=arguments.measurement,
        size=size,
        load=load,
        picture=arguments.shape,
        flipped=arguments.flipped,
        lines=arguments.lines,
    )
    laws = [[LawFrom(*_law(each)) for each in text.split("+")] for text in arguments.laws]
    found, scored = run(laws, target, arguments.output)
    if arguments.figure:
        write(read(arguments.output), arguments.output, arguments.figure)
    if arguments.json:
        print(json.dumps({"remarks": found.remarks, **scored.stored()}, indent=1))
    else:
        print("\n".join(listing(found, scored)))
        print("\n".join(f"written   {file}" for file in (arguments.output, *arguments.figure)))
    return 0


def _check(arguments) -> None:
    """Nothing, where the options belong together."""
    if arguments.measurement and (arguments.size or arguments.stretches):
        raise UsageError("--size and --stretches are of a sheet without a test: leave them out, or the measurement")
    if not arguments.measurement and not (arguments.size and arguments.stretches):
        raise UsageError(
            "name the measurement of the sheet, results/CASE/measurement.nc, or give --size and --stretches of one "
            "that has not been tested"
        )
    if arguments.flipped and not arguments.shape:
        raise UsageError("--flipped: is of a picture: add --shape PICTURE")
    for file in arguments.figure:
        if file.suffix.lower() not in (".pdf", ".png"):
            raise UsageError(f"--figure {file}: name a file that ends in .pdf or .png")


def _law(text: str) -> tuple[Path, int | None]:
    """(run, phase) of ``RUN[:PHASE]``."""
    run, sign, phase = text.rpartition(":")
    if not sign:
        return Path(text), None
    if not phase.isdigit() or not run:
        raise UsageError(f"--laws {text}: write RUN or RUN:PHASE, such as results/leaf/hypernode:1")
    return Path(run), int(phase)


def listing(found, scored) -> list[str]:
    """A line for each load step, then what limits the prediction."""
    import numpy as np

    lines = ["step  force [N]        off     displacement off (noise alone)"]
    for step, (force, spread) in enumerate(zip(found.force, found.force_spread, strict=True)):
        place = np.unravel_index(np.nanargmax(force), force.shape)
        errors = (scored.force_error, scored.displacement_error, scored.displacement_noise)
        off, u_off, noise = (f"{100.0 * each[step]:.2g} %" if each else "-" for each in errors)
        lines.append(f"{step:4d}  {force[place]:.4g} ± {spread[place]:.2g}".ljust(24) + f"{off:7} {u_off} ({noise})")
    for what, share in (("forces", scored.force_within), ("displacements", scored.displacement_within)):
        if share is not None:
            lines.append(f"{100.0 * share:.0f} % of the {what} are within two spreads")
    return [*lines, *(f"note: {remark}" for remark in found.remarks)]
