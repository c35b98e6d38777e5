"""``hypernode phases MEASUREMENT``: the laws of the phases of a sheet whose shape is known."""

from pathlib import Path

from hypernode.commands.options import UsageError


def add_phases(commands) -> None:
    """``phases MEASUREMENT``."""
    parser = commands.add_parser(
        "phases", help="identify the laws of the phases of a sheet whose shape is known, for predict"
    )
    parser.add_argument("measurement", type=Path, metavar="MEASUREMENT", help="its results/CASE/measurement.nc")
    parser.add_argument(
        "--shape",
        type=Path,
        metavar="PICTURE",
        help="grey levels are phases, the darkest the softest; left out, the sheet is homogeneous",
    )
    parser.add_argument("--flipped", action="store_true", help="the first row of the picture is at the bottom")
    parser.add_argument("--count", type=int, default=2, metavar="N", help="of phases (2)")
    parser.add_argument("--method", default="hypernode", metavar="NAME", help="a preset with few materials (hypernode)")
    parser.add_argument(
        "--output", type=Path, default=Path("phases"), metavar="FOLDER", help="where constrained.nc is written (phases)"
    )
    parser.set_defaults(run=run_phases)


def run_phases(arguments) -> int:
    """Identify, write, and print the law of each phase.

    Raises:
        UsageError: the method is none of few materials, or there is one phase.
        PredictionError, IdentificationError, StorageError: see :func:`hypernode.stages.phases.run`.
    """
    from hypernode.config.methods import Constrained
    from hypernode.config.presets import presets

    section = presets().get(arguments.method, {}).get("constrained")
    if section is None or not section.get("layers"):
        names = ", ".join(key for key, each in presets().items() if (each.get("constrained") or {}).get("layers"))
        raise UsageError(f"--method {arguments.method}: seeks no few materials; choose one of {names}")
    if arguments.count < 2:
        raise UsageError(f"--count {arguments.count}: a picture has two phases or more; of one phase leave out --shape")
    if arguments.flipped and not arguments.shape:
        raise UsageError("--flipped: is of a picture: add --shape PICTURE")
    from hypernode.pipeline.compiler import set_up_compiler

    set_up_compiler(float64=True)
    from hypernode.stages.phases import run

    settings = Constrained.model_validate(section)
    found = run(settings, arguments.measurement, arguments.shape, arguments.flipped, arguments.count, arguments.output)
    print(f"law       {', '.join(found.basis.terms) or 'neo-Hookean'}; {found.ending}")
    print(f"missed    displacements by {found.misfits['displacement']:.3g} times their noise")
    print(f"written   {arguments.output / 'constrained.nc'}")
    return 0
