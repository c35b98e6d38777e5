"""Command line: ``python -m hypernode audit verify | explain | diff``, ``schema``, and ``idle`` before a resume."""

import argparse
import json
import os
import sys
from pathlib import Path

from hypernode.errors import ExpectedError


def _verify(arguments) -> int:
    from hypernode.storage.audit import result_files, verify

    problems = verify(arguments.folder)
    if arguments.json:
        print(json.dumps({"folder": str(arguments.folder), "problems": problems}, indent=1))
    else:
        print("\n".join(problems) or f"{len(result_files(arguments.folder))} files, all as they were written")
    return 1 if problems else 0


def _explain(arguments) -> int:
    from hypernode.storage.audit import lineage, tree

    found = lineage(arguments.file.resolve())
    print(json.dumps(found, indent=1, sort_keys=True) if arguments.json else "\n".join(tree(found, Path.cwd())))
    return 0


def _diff(arguments) -> int:
    from hypernode.storage.audit import compare

    entries = compare(arguments.first, arguments.second)
    if arguments.json:
        print(json.dumps(entries, indent=1))
    else:
        lines = [line for entry in entries for line in (entry["file"], *(f"  {d}" for d in entry["differences"]))]
        print("\n".join(lines) or "the same results")
    return 1 if entries else 0


def _schema(arguments) -> int:
    from hypernode.storage.schema import page

    print(page(), end="")
    return 0


def _idle(arguments) -> int:
    """Whether no workflow is running in this folder, so that its lock may be taken away."""
    here, running = Path.cwd().resolve(), []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            words = (process / "cmdline").read_bytes().decode(errors="replace").split("\0")
            at = (process / "cwd").resolve()
        except OSError:
            continue
        if at == here and any(Path(word).name == "snakemake" for word in words[:4]):
            running.append(process.name)
    if running:
        print(f"error: a run is going on in this folder (process {', '.join(running)})", file=sys.stderr)
        return 1
    return 0


def parser() -> argparse.ArgumentParser:
    """The command line's parser."""
    top = argparse.ArgumentParser(prog="python -m hypernode", description=__doc__)
    commands = top.add_subparsers(dest="command", required=True)
    audit = commands.add_parser("audit", help="where results came from and whether they are intact")
    actions = audit.add_subparsers(dest="action", required=True)
    verify = actions.add_parser("verify", help="rehash every result and its ancestry; exit code 1 on any problem")
    verify.add_argument("folder", type=Path, nargs="?", default=Path("results"))
    verify.set_defaults(run=_verify)
    explain = actions.add_parser("explain", help="the lineage of a figure, table or NetCDF file")
    explain.add_argument("file", type=Path)
    explain.set_defaults(run=_explain)
    diff = actions.add_parser("diff", help="what differs between two results folders, earliest stage first")
    diff.add_argument("first", type=Path)
    diff.add_argument("second", type=Path)
    diff.set_defaults(run=_diff)
    idle = commands.add_parser("idle", help="exit code 0 where no workflow runs in this folder")
    idle.set_defaults(run=_idle)
    schema = commands.add_parser("schema", help="what result files hold, as a Markdown page")
    schema.set_defaults(run=_schema)
    for action in (verify, explain, diff):
        action.add_argument("--json", action="store_true", help="for machines")
    return top


def main(argv=None) -> int:
    """Run a command; expected errors become one line on standard error and exit code 2."""
    arguments = parser().parse_args(argv)
    try:
        return arguments.run(arguments)
    except BrokenPipeError:
        # The reader of a pipe (head, less) has seen enough.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except (ExpectedError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
