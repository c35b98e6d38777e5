"""What jobs on other machines than that of Snakemake need to be told (docs/decisions/0048)."""

import atexit
import contextlib
import hashlib
import os
from pathlib import Path

from hypernode.pipeline.liveness import shown_alive

#: The kernel's own name of the time since it was started: that of no other machine, whatever containers run on it.
_BOOT = Path("/proc/sys/kernel/random/boot_id")


def machine() -> str:
    """A name of this machine that no other one has, empty where the system gives none; names of hosts may repeat."""
    try:
        return hashlib.sha256(_BOOT.read_bytes()).hexdigest()[:12]
    except OSError:
        return ""


def keep_compiled_by_machine(workflow) -> None:
    """Let jobs that another machine's Snakemake has sent here keep what they compile apart from other machines.

    What is kept is not written in one step, so that two machines that write one file of a shared folder may leave half
    of it. ``HYPERNODE_CACHE`` has the last word. Call it where the Snakefile is read.

    Args:
        workflow: Snakemake's.
    """
    if getattr(workflow, "remote_exec", False) and machine():
        os.environ.setdefault("HYPERNODE_CACHE", str(Path(".cache") / machine()))


def show_run_alive(workflow) -> None:
    """Show, while this Snakemake runs, that a run is going on in its folder, here or by a job that was sent here.

    Call it where the Snakefile is read.

    Args:
        workflow: Snakemake's.
    """
    runs = getattr(workflow, "executor_plugin", None) is not None and not workflow.dryrun
    sent = getattr(workflow, "remote_exec", False)
    if runs and (sent or getattr(workflow, "is_main_process", False)):
        signs = contextlib.ExitStack()
        signs.enter_context(shown_alive("a job of the run" if sent else "the run itself"))
        atexit.register(signs.close)
