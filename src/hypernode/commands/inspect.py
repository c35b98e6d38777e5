"""``hypernode inspect FOLDER``: what a folder of displacement files holds, and what is missing to identify it."""

import json
import sys
from pathlib import Path

from hypernode.commands.options import add_folder_options, figure_files, given_settings, keep_out


def add_inspect(commands) -> None:
    """``inspect FOLDER``."""
    parser = commands.add_parser(
        "inspect",
        help="what a folder of displacement files holds; exit code 1 where something is missing or refused",
    )
    add_folder_options(parser)
    parser.add_argument(
        "--write-config", type=Path, metavar="FILE", help="write the smallest configuration that identifies it"
    )
    parser.set_defaults(run=run_inspect)


def run_inspect(arguments) -> int:
    """Print what is found out; exit code 1 where the folder cannot be imported with what is known."""
    seen = looked_at(arguments)
    written = []
    if arguments.write_config and seen.sheet is not None:
        from hypernode.inspection.draft import write_draft

        write_draft(seen, arguments.write_config)
        written = [arguments.write_config]
    print_report(arguments, seen, written)
    unwritten = [] if seen.load is not None else figure_files(arguments, seen.name)
    unwritten += [arguments.write_config] if arguments.write_config and not written else []
    for file in unwritten:
        print(f"error: {file} is not written", file=sys.stderr)
    return 0 if seen.sheet is not None else 1


def looked_at(arguments):
    """The inspection of the folder that the command line names, drawn where it asks for a figure.

    Raises:
        UsageError: a file would be written into the folder.
        DicError, ConfigError: there is no such folder, key or value.
    """
    from hypernode.inspection.folder import inspect, named_after
    from hypernode.inspection.view import view_of

    files = figure_files(arguments, named_after(arguments.folder))
    if arguments.write_config:
        keep_out(arguments.folder, arguments.write_config)
    seen = inspect(arguments.folder, given_settings(arguments))
    if files and seen.load is not None:
        from hypernode.figures.folder import write

        write(view_of(seen), files)
    return seen


def print_report(arguments, seen, written=()) -> None:
    """Print the report, for people or for machines, and the files that were written."""
    from hypernode.inspection.as_json import as_json
    from hypernode.inspection.report import report

    drawn = figure_files(arguments, seen.name) if seen.load is not None else []
    files = [str(file) for file in (*drawn, *written)]
    if arguments.json:
        print(json.dumps({**as_json(seen), "written": files}, indent=1, allow_nan=False))
    else:
        print("\n".join([*report(seen), *(f"written   {file}" for file in files)]))
