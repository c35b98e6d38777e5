"""``hypernode correlate FOLDER OUTPUT``: pictures of a real test become displacement files and a force record."""

from pathlib import Path

from pydantic import ValidationError

from hypernode.commands.options import UsageError
from hypernode.config.correlation import Correlation


def add_correlate(commands) -> None:
    """``correlate FOLDER OUTPUT``."""
    parser = commands.add_parser("correlate", help="follow points through pictures; what it writes is then inspected")
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder of the pictures and the force record")
    parser.add_argument("output", type=Path, metavar="OUTPUT", help="a new folder")
    parser.add_argument("--pictures", default="*.tif", metavar="PATTERN", help="of their names (*.tif)")
    parser.add_argument("--pixel-size", type=float, required=True, metavar="MM", help="length of a pixel on the sheet")
    parser.add_argument("--reference", choices=("first", "last"), default="first", help="the least loaded picture")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="take one picture of so many (1)")
    parser.add_argument("--region", type=int, nargs=4, metavar=("COLUMN", "ROW", "WIDTH", "HEIGHT"), help="[pixel]")
    parser.add_argument("--mask", type=Path, metavar="FILE", help="picture that is white where points are followed")
    parser.add_argument("--force-file", metavar="NAME", help="machine's record, whose clock the names tell")
    parser.add_argument("--force-set", metavar="NAME", help="set of cycles of a record of several")
    parser.add_argument("--force-cycle", metavar="NAME", help="cycle of a record of several")
    parser.add_argument("--threads", type=int, default=1, metavar="N", help="of the processor (1)")
    default = Correlation()
    parser.add_argument("--engine", default=default.engine, help="pyvale, al_dic or finite_elements (pyvale)")
    parser.add_argument("--subset", type=int, default=default.subset, metavar="PIXELS", help=f"odd ({default.subset})")
    parser.add_argument(
        "--step", type=int, default=default.step, metavar="PIXELS", help=f"of the grid ({default.step})"
    )
    parser.add_argument("--shape", default=default.shape, help="affine or quadratic (affine)")
    parser.add_argument(
        "--reach", type=int, default=default.reach, metavar="PIXELS", help=f"searched ({default.reach})"
    )
    parser.add_argument("--incremental", action="store_true", help="compare each picture with the one before")
    parser.set_defaults(run=run_correlate)


def run_correlate(arguments) -> int:
    """Write the folder and print what was followed, and what a specimen has to say of it."""
    if arguments.pixel_size <= 0 or arguments.every < 1 or arguments.threads < 1:
        raise UsageError("--pixel-size, --every and --threads: more than zero")
    try:
        settings = Correlation(**{key: getattr(arguments, key) for key in Correlation.model_fields})
    except ValidationError as error:
        first = error.errors()[0]
        raise UsageError(f"{' '.join(f'--{part}' for part in first['loc'])} {first['msg']}".strip()) from None
    from hypernode.stages.correlate_files import Photographs, run

    photographs = Photographs(
        folder=arguments.folder,
        pattern=arguments.pictures,
        mm_per_pixel=arguments.pixel_size,
        reference=arguments.reference,
        every=arguments.every,
        region=tuple(arguments.region) if arguments.region else None,
        mask=arguments.mask,
        force_file=arguments.force_file,
        force_set=arguments.force_set,
        force_cycle=arguments.force_cycle,
    )
    said = run(photographs, settings, arguments.output, arguments.threads)
    print(f"written   {arguments.output}, {len(said['pictures'])} pictures by {settings.engine}")
    least = min(said["followed"])
    print(f"points    {said['points']}, of which {least} were followed in the picture that lost most")
    print(f"set       correlation_window: {said['correlation_window']:.4g}")
    print(f"          correlation_kernel: {said['correlation_kernel']}")
    return 0
