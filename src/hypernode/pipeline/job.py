"""How one job of the workflow runs: its cores, its log, its errors, its end, its attributes.

Enter :func:`job` before JAX is imported: it decides on how many CPUs and in which precision JAX computes.
"""

import contextlib
import ctypes
import os
import signal
import sys
import traceback

from hypernode.errors import ExpectedError
from hypernode.pipeline.compiler import DOUBLE_PRECISION, require_platform, set_up_compiler
from hypernode.pipeline.cores import claimed_cores
from hypernode.pipeline.liveness import shown_alive
from hypernode.pipeline.phases import Phases
from hypernode.storage.provenance import describe

_PR_SET_PDEATHSIG = 1


def die_with_parent() -> None:
    """Ask the kernel to kill this process when its parent dies, so that no orphan goes on computing.

    Where the parent died while this process was still starting, the kernel has nobody left to watch. This process
    then belongs to another one, of another session, and ends here.
    """
    ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getsid(os.getppid()) != os.getsid(0):
        os._exit(1)


class _Tee:
    """Writes to the terminal and to the job's log."""

    def __init__(self, *streams):
        self.streams = streams

    def write(self, text):
        """Write to every stream."""
        for stream in self.streams:
            # A full disk must not stop the message about it from reaching the terminal.
            with contextlib.suppress(OSError):
                stream.write(text)
        return len(text)

    def flush(self):
        """Flush every stream."""
        for stream in self.streams:
            with contextlib.suppress(OSError):
                stream.flush()


@contextlib.contextmanager
def job(snakemake):
    """Set a workflow script up and turn expected errors into one line.

    Args:
        snakemake: the object that Snakemake gives to scripts.

    Yields:
        The attributes that the job's output file carries.
    """
    die_with_parent()
    platform = snakemake.params.get("platform", "cpu")
    set_up_compiler(snakemake.rule in DOUBLE_PRECISION, platform)
    # Open until the process ends: the traceback of an error that nobody expected goes there as well.
    log = open(str(snakemake.log[0]), "w", buffering=1)
    sys.stderr = _Tee(sys.__stderr__, log)
    # Elsewhere JAX is imported later than a job could listen to it.
    phases = Phases().listen() if "jax" in sys.modules else None
    params, run = snakemake.params, dict(snakemake.wildcards)
    where = ", ".join(f"{key} {value}" for key, value in run.items())
    with claimed_cores(snakemake.threads), shown_alive(f"{snakemake.rule} ({where})"):
        try:
            require_platform(platform)
            yield describe(snakemake.rule, run, params.get("settings", {}), params.code)
            if phases is not None:
                with contextlib.suppress(OSError):
                    print(phases.line(), file=log)
        except (ExpectedError, ValueError, OSError) as error:
            with contextlib.suppress(OSError):
                traceback.print_exc(file=log)
            print(f"error in {snakemake.rule} ({where}): {error}", file=sys.stderr)
            sys.exit(1)
