"""The command hypernode: look at measurements, identify them, and ask results how far to believe them.

A command is a function that adds its parser to those of ``COMMANDS``, with a ``run`` that takes the arguments and
gives the exit code. It imports what it needs when it runs, so that no command waits for another one's packages.
"""

import argparse
import json
import os
import sys
from pathlib import Path

from hypernode.commands.advise import add_advise
from hypernode.commands.challenge import add_challenge
from hypernode.commands.correlate import add_correlate
from hypernode.commands.explain import add_explain
from hypernode.commands.explore import add_explore
from hypernode.commands.export import add_export
from hypernode.commands.identify import add_identify
from hypernode.commands.inspect import add_inspect
from hypernode.commands.phases import add_phases
from hypernode.commands.practice import add_practice
from hypernode.commands.predict import add_predict
from hypernode.errors import ExpectedError
from hypernode.installation import needs
from hypernode.progress import LEVEL, LEVELS, set_level


def add_audit(commands) -> None:
    """``audit verify | explain | diff | report``."""
    audit = commands.add_parser("audit", help="where results came from and whether they are intact")
    actions = audit.add_subparsers(dest="action", required=True)
    verify = actions.add_parser("verify", help="rehash results and ancestry, compare how they were made; exit code 1")
    verify.add_argument("folder", type=Path, nargs="?", default=Path("results"))
    verify.set_defaults(run=audit_verify)
    explain = actions.add_parser("explain", help="the lineage of a figure, table or NetCDF file")
    explain.add_argument("file", type=Path)
    explain.set_defaults(run=audit_explain)
    diff = actions.add_parser("diff", help="what differs between two results folders, earliest stage first")
    diff.add_argument("first", type=Path)
    diff.add_argument("second", type=Path)
    diff.set_defaults(run=audit_diff)
    for action in (verify, explain, diff):
        action.add_argument("--json", action="store_true", help="for machines")
    report = actions.add_parser("report", help="file a Snakemake report among the results that it shows")
    report.add_argument("report", type=Path)
    report.add_argument("folder", type=Path, nargs="?", default=Path("results"))
    report.set_defaults(run=audit_report)


def audit_verify(arguments) -> int:
    """Print problems and notices; exit code 1 where there is a problem."""
    from hypernode.pipeline.compiler import rule_settings
    from hypernode.storage.audit import verify
    from hypernode.storage.records import result_files

    found = verify(arguments.folder, rule_settings)
    problems, notices = [[each for each in found if each.notice is kind] for kind in (False, True)]
    if arguments.json:
        kinds = {"problems": problems, "notices": notices}
        lists = {kind: [{"file": f.file, "message": f.message} for f in each] for kind, each in kinds.items()}
        print(json.dumps({"folder": str(arguments.folder), **lists}, indent=1))
    else:
        for each in problems + notices:
            print(each)
        if not problems:
            print(f"{len(result_files(arguments.folder))} files, all as they were written")
    return 1 if problems else 0


def audit_explain(arguments) -> int:
    """Print the lineage of a file."""
    from hypernode.storage.lineage import lineage, tree

    found = lineage(arguments.file.resolve())
    print(json.dumps(found, indent=1, sort_keys=True) if arguments.json else "\n".join(tree(found, Path.cwd())))
    return 0


def audit_diff(arguments) -> int:
    """Print what differs between two runs; exit code 1 where anything does."""
    from hypernode.storage.differences import compare

    entries = compare(arguments.first, arguments.second)
    if arguments.json:
        print(json.dumps(entries, indent=1))
    else:
        lines = [line for entry in entries for line in (entry["file"], *(f"  {d}" for d in entry["differences"]))]
        print("\n".join(lines) or "the same results")
    return 1 if entries else 0


def audit_report(arguments) -> int:
    """Copy a report into the results folder, with a record."""
    from hypernode.storage.report import file_report

    print(file_report(arguments.report, arguments.folder))
    return 0


def add_verdict(commands) -> None:
    """``verdict``."""
    parser = commands.add_parser("verdict", help="how far each run can be believed, the worst first; exit code 1")
    parser.add_argument("folder", type=Path, nargs="?", default=Path("results"))
    parser.add_argument("--json", action="store_true", help="for machines")
    parser.set_defaults(run=verdict)


def verdict(arguments) -> int:
    """Print the verdict on every run; exit code 1 where any fails."""
    from hypernode.tables.verdicts import evaluations, listing, read_verdicts
    from hypernode.verdict import Level

    found = read_verdicts(evaluations(arguments.folder))
    if arguments.json:
        print(json.dumps([{"run": run, **each.stored()} for run, each in found], indent=1))
    else:
        print("\n".join(listing(found)))
    return 1 if any(each.overall is Level.FAILED for _, each in found) else 0


def add_schema(commands) -> None:
    """``schema [files | config]``."""
    schema = commands.add_parser(
        "schema", help="what result files hold, as a Markdown page, or configurations, as JSON"
    )
    schema.add_argument("what", nargs="?", choices=tuple(SCHEMAS), default="files")
    schema.set_defaults(run=lambda arguments: SCHEMAS[arguments.what]())


def schema_files() -> int:
    """Print the page of what result files hold."""
    from hypernode.storage.schema_page import page

    print(page(), end="")
    return 0


def schema_config() -> int:
    """Print the JSON Schema of the configuration."""
    from hypernode.config.json_schema import text

    print(text(), end="")
    return 0


SCHEMAS = {"files": schema_files, "config": schema_config}


def add_idle(commands) -> None:
    """``idle``."""
    commands.add_parser(
        "idle", help="exit code 0 where no workflow and no job runs in this folder, on any machine"
    ).set_defaults(run=idle)


def idle(arguments) -> int:
    """Whether no workflow and no job of one is at work in this folder, on any machine, so that its lock may go."""
    from hypernode.pipeline.liveness import at_work

    running = at_work()
    if running:
        shown = "; ".join(running[:5]) + ("; ..." if len(running) > 5 else "")
        print(f"error: {len(running)} at work in this folder ({shown}): wait, or end them", file=sys.stderr)
    return int(bool(running))


def add_export_csv(commands) -> None:
    """``export-csv``."""
    parser = commands.add_parser(
        "export-csv", help="write a measurement as frames, force records and the configuration that imports them again"
    )
    parser.add_argument("measurement", type=Path, help="results/CASE/measurement.nc")
    parser.add_argument("folder", type=Path, help="a new folder")
    parser.set_defaults(run=export_csv)


def export_csv(arguments) -> int:
    """Write the export and print where its configuration is."""
    from hypernode.stages.export_csv import run

    print(run(arguments.measurement, arguments.folder))
    return 0


COMMANDS = (
    add_practice,
    add_correlate,
    add_inspect,
    add_identify,
    add_explain,
    add_explore,
    add_advise,
    add_phases,
    add_predict,
    add_challenge,
    add_audit,
    add_verdict,
    add_schema,
    add_export,
    add_export_csv,
    add_idle,
)


def parser() -> argparse.ArgumentParser:
    """The command line's parser."""
    top = argparse.ArgumentParser(prog="hypernode", description=__doc__.splitlines()[0])
    levels = "debug, info or warning; also for the jobs of a run"
    top.add_argument("--log", choices=LEVELS, metavar="LEVEL", help=f"how much is said of progress: {levels}")
    commands = top.add_subparsers(dest="command", required=True)
    for add in COMMANDS:
        add(commands)
    return top


def main(argv=None) -> int:
    """Run a command; expected errors become one line on standard error and exit code 2."""
    arguments = parser().parse_args(argv)
    if arguments.log:
        os.environ[LEVEL] = arguments.log
        set_level()
    try:
        return arguments.run(arguments)
    except BrokenPipeError:
        # The reader of a pipe (head, less) has seen enough.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except (ExpectedError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except ModuleNotFoundError as error:
        if not (sentence := needs(error.name or "")):
            raise
        print(f"error: {sentence}", file=sys.stderr)
        return 2
