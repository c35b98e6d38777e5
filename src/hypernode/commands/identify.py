"""``hypernode identify FOLDER``: from a folder to a material and the verdict on it, by the project's own workflow."""

import importlib.util
import json
import re
import subprocess
import sys
from pathlib import Path

from hypernode.commands.inspect import looked_at, print_report
from hypernode.commands.options import UsageError, add_folder_options
from hypernode.errors import ExpectedError
from hypernode.installation import needs, project_folder
from hypernode.pipeline.liveness import at_work

#: A refusal of the workflow, and one of a job, which names its rule and case.
_REFUSAL = re.compile(r"error(?: in \w+ \(.*?\))?: ")
#: What the project itself says during a run: progress of a stage, jobs that are done, refusals.
_OWN = re.compile(rf"\[[a-z][a-z_ -]*\] |{_REFUSAL.pattern}|\d+ of \d+ steps")
#: Where everything that was said is kept when a run ends with an error.
LOG = Path("results/logs/identify.log")


class WorkflowError(ExpectedError):
    """The workflow cannot run, or ended with an error."""


def add_identify(commands) -> None:
    """``identify FOLDER``."""
    parser = commands.add_parser(
        "identify",
        help="identify the material of a folder; exit code 1 where the verdict is fail, 2 where something is refused",
    )
    add_folder_options(parser)
    parser.add_argument("--method", metavar="NAME", help="preset, or method of a file of --config; hypernode if not")
    parser.add_argument("--cores", type=int, default=2, metavar="N", help="that jobs may use (2)")
    parser.add_argument(
        "--config", type=Path, nargs="+", default=[], metavar="FILE", help="configurations that are laid over"
    )
    parser.add_argument(
        "--write-config", type=Path, metavar="FILE", help="where the configuration is written (<folder>.yaml here)"
    )
    parser.set_defaults(run=run_identify)


def run_identify(arguments) -> int:
    """Inspect, write the configuration, run the workflow, and print the verdict and where the results are."""
    from hypernode.inspection.draft import write_draft

    if arguments.cores < 1:
        raise UsageError(f"--cores {arguments.cores}: one or more")
    snakefile = workflow(project_folder())
    seen = looked_at(arguments)
    if seen.sheet is None:
        print_report(arguments, seen)
        return 2
    file = arguments.write_config or Path(f"{seen.name}.yaml")
    config = write_draft(seen, file, arguments.method, arguments.config)
    if not arguments.json:
        print_report(arguments, seen, [file])
    sys.stdout.flush()
    run_workflow(snakefile, [file, *arguments.config], arguments.cores)
    return print_results(arguments, config, seen.name)


def workflow(root: Path | None) -> Path:
    """The project's Snakefile.

    Raises:
        WorkflowError: there is none, or nothing to run it with.
    """
    if importlib.util.find_spec("snakemake") is None:
        raise WorkflowError(needs("snakemake"))
    if root is None or not (root / "Snakefile").is_file():
        raise WorkflowError(
            "the Snakefile of the workflow is not where this installation would have put it: install the project again"
        )
    return root / "Snakefile"


def run_workflow(snakefile: Path, configs: list[Path], cores: int) -> None:
    """Run everything that configurations ask for, into ``results`` of the working directory.

    Raises:
        WorkflowError: it ended with an error.
    """
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(snakefile), "--cores", str(cores)]
    command += ["--workflow-profile", str(snakefile.parent / "profiles" / "default")]
    # What a job says and how many are done is progress; what files it reads and why is not.
    quiet = ["--quiet", "rules", "host", "reason", "--configfile", *map(str, configs)]
    _unlock([*command, *quiet])
    done, said = _told([*command, *quiet])
    if done != 0:
        cause = cause_of(said)
        LOG.parent.mkdir(parents=True, exist_ok=True)
        LOG.write_text("\n".join(said) + "\n", encoding="utf-8")
        raise WorkflowError(
            f"{cause + ': ' if cause else ''}the run did not end; what is finished is kept, and the same command goes "
            f"on from there; everything that was said is in {LOG}"
        )


def cause_of(said: list[str]) -> str:
    """What the project said last of a run that ended with an error; empty if it said nothing."""
    refusals = [line for line in said if _REFUSAL.match(line)]
    return _REFUSAL.sub("", refusals[-1], count=1) if refusals else ""


def _unlock(command: list[str]) -> None:
    """Take away the lock of a run that was killed.

    Raises:
        WorkflowError: a run is still at work in this folder.
    """
    if not any(Path(".snakemake/locks").glob("*")):
        return
    if running := at_work():
        raise WorkflowError(f"another run is at work in this folder ({running[0]}): wait until it ends, or end it")
    subprocess.run([*command, "--unlock"], capture_output=True)  # noqa: S603


def _told(command: list[str]) -> tuple[int, list[str]]:
    """(exit code, every line that was said), the project's own lines on standard error as they come."""
    # Standard output is for results.
    with subprocess.Popen(  # noqa: S603
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, encoding="utf-8", errors="replace"
    ) as running:
        said = []
        try:
            for line in running.stdout:
                said.append(line.rstrip("\n"))
                if _OWN.match(line):
                    print(said[-1], file=sys.stderr, flush=True)
        except KeyboardInterrupt:
            running.terminate()
            running.communicate()
            raise WorkflowError("stopped; what is finished is kept, and the same command goes on from there") from None
    return running.returncode, said


def print_results(arguments, config, specimen: str) -> int:
    """Print the verdicts on the runs of a specimen and their files; exit code 1 where one fails."""
    from hypernode.tables.verdicts import read_verdicts
    from hypernode.verdict import Level

    runs = [
        f"{name}/{method}"
        for name, case in config.cases.items()
        if case.specimen == specimen
        for method in case.methods
    ]
    found = read_verdicts(f"results/{run}/evaluation.nc" for run in runs)
    files = {run: [f"results/{run}/material.nc", *_figures(config, run), *_explorers(config, run)] for run in runs}
    if arguments.json:
        print(json.dumps([{"run": run, **each.stored(), "files": files[run]} for run, each in found], indent=1))
    else:
        print("\n".join(line for run, each in found for line in (f"{each.overall}  {run}", *_reasons(each))))
        print("\n".join(f"written   {file}" for run in runs for file in files[run]))
    return 1 if any(each.overall is Level.FAILED for _, each in found) else 0


def _reasons(verdict) -> list[str]:
    """A line for every criterion that is judged, the worst first, then one for every suspect."""
    from hypernode.verdict import Level

    judged = [each for each in verdict.criteria if each.level is not Level.NOT_JUDGED]
    lines = [f"  {each.level}: {each.sentence}" for each in sorted(judged, key=lambda each: -each.level.rank)]
    return [*lines, *(f"  {each}" for each in verdict.causes)]


def _figures(config, run: str) -> list[str]:
    """Figures of one run."""
    return [
        f"results/figures/{name}.{kind}"
        for name, figure in config.figures.items()
        if hasattr(figure, "method") and f"{figure.case}/{figure.method}" == run
        for kind in ("pdf", "png")
    ]


def _explorers(config, run: str) -> list[str]:
    """The explorer of one run, where it has one."""
    return [f"results/{run}/explorer.html"] * any(f"{each.case}/{each.method}" == run for each in config.explorers)
