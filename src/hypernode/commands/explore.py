"""``hypernode explore results/CASE/METHOD``: one HTML file that shows a run and answers at any point of its sheet."""

from pathlib import Path

from hypernode.commands.options import UsageError


def add_explore(commands) -> None:
    """``explore FOLDER [OTHER]``."""
    parser = commands.add_parser(
        "explore", help="write one HTML file in which a run is looked at, and asked for a curve at any point"
    )
    parser.add_argument("folder", type=Path, metavar="results/CASE/METHOD", help="a finished run")
    parser.add_argument("other", type=Path, nargs="?", metavar="OTHER/METHOD", help="another one, shown beside it")
    parser.add_argument("--output", type=Path, metavar="FILE.html", help="explore_CASE_METHOD.html here, if not named")
    parser.set_defaults(run=run_explore)


def run_explore(arguments) -> int:
    """Write the file and print where it is.

    Raises:
        UsageError: the name of the file does not end in .html.
        StorageError, ExplorerError: the run cannot be read or shown.
    """
    folder = arguments.folder.resolve()
    output = arguments.output or Path(f"explore_{folder.parent.name}_{folder.name}.html")
    if output.suffix.lower() not in (".html", ".htm"):
        raise UsageError(f"--output {output}: name a file that ends in .html")
    from hypernode.stages.explorer import files_of, page

    beside = files_of(arguments.other) if arguments.other else {}
    text = page(files_of(arguments.folder), beside)
    output.write_text(text, encoding="utf-8")
    print(f"{output}  {len(text.encode()) / 1e6:.1f} MB, opens in any browser")
    return 0
