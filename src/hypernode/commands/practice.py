"""``hypernode practice FOLDER``: a folder of frames and a force record whose material is known, to practise with."""

from pathlib import Path

from hypernode.commands.options import UsageError
from hypernode.mechanics.loads import CONSTRAINED

#: Loads that a machine can be told.
LOADS = tuple(kind for kind in CONSTRAINED if kind not in ("general", "equibiaxial"))
#: Standard deviation of a displacement where none is given [mm]: a fiftieth of a pixel of 0.2 mm.
NOISE = 0.004


def add_practice(commands) -> None:
    """``practice FOLDER``."""
    parser = commands.add_parser("practice", help="write frames and the force record of a known sheet")
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="a new folder")
    parser.add_argument("--load", default="clamped_y", choices=LOADS, metavar="KIND", help=", ".join(LOADS))
    parser.add_argument("--noise", type=float, default=NOISE, metavar="MM", help=f"of a displacement ({NOISE} mm)")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="of the noise (0)")
    parser.set_defaults(run=run_practice)


def run_practice(arguments) -> int:
    """Write the folder and print what the sheet in it is."""
    if not 0.0 <= arguments.noise < float("inf"):
        raise UsageError(f"--noise {arguments.noise}: zero or more")
    from hypernode.pipeline.compiler import set_up_compiler

    set_up_compiler(float64=True)
    from hypernode.stages.practice import run
    from hypernode.synthetic import practice as sheet

    folder = run(arguments.folder, arguments.load, arguments.noise, arguments.seed)
    print(f"written   {folder}")
    print(f"sheet     {sheet.SIDE:g} x {sheet.SIDE:g} x {sheet.THICKNESS:g} mm, neo-Hookean, {sheet.MATRIX} MPa")
    x, y = sheet.CENTRE
    print(
        f"inclusion a disc at {x:g}, {y:g} mm with a radius of {sheet.RADIUS:g} mm, neo-Hookean, {sheet.INCLUSION} MPa"
    )
    print(f"test      {arguments.load} to a stretch of {sheet.STRETCH}, one frame a second")
    return 0
