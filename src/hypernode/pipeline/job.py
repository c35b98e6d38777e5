"""How one job of the workflow runs: its cores, its log, its errors, its attributes.

This module must be imported before JAX: it pins the process to as many CPUs as the job declares, so
that XLA's thread pool has that size and two jobs on two cores do not fight.
"""

import contextlib
import ctypes
import fcntl
import os
import signal
import sys
import tempfile
import traceback
from pathlib import Path

from hypernode.errors import ExpectedError
from hypernode.pipeline.compiler import set_up_compiler
from hypernode.storage.provenance import describe

_PR_SET_PDEATHSIG = 1
#: Kept open for the life of the process: closing a file gives its lock back.
_held = []


def claim_cores(count: int) -> list[int]:
    """Pin this process to ``count`` CPUs that no other job of this user has claimed.

    A claim is a lock on a file per CPU, which the kernel drops when the process ends, however it
    ends. Where too few are free, the remaining ones are shared.
    """
    allowed = sorted(os.sched_getaffinity(0))
    chosen = []
    for cpu in allowed:
        if len(chosen) == count:
            break
        path = Path(tempfile.gettempdir()) / f"hypernode-{os.getuid()}-cpu{cpu}.lock"
        handle = open(path, "w")
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            handle.close()
            continue
        _held.append(handle)
        chosen.append(cpu)
    spare = [cpu for cpu in allowed if cpu not in chosen]
    start = os.getpid() % max(len(spare), 1)
    chosen += (spare[start:] + spare[:start])[: count - len(chosen)]
    os.sched_setaffinity(0, chosen)
    return chosen


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
def job(snakemake, float64: bool = False):
    """Set a workflow script up and turn expected errors into one line.

    Args:
        snakemake: the object that Snakemake gives to scripts.
        float64: whether JAX computes in double precision (finite elements do, training does not).

    Yields:
        The attributes that the job's output file carries.
    """
    die_with_parent()
    claim_cores(snakemake.threads)
    log = open(str(snakemake.log[0]), "w", buffering=1)
    sys.stderr = _Tee(sys.__stderr__, log)
    set_up_compiler(float64)

    try:
        yield describe(
            snakemake.rule, dict(snakemake.wildcards), snakemake.params.get("settings", {}), snakemake.params.code
        )
    except (ExpectedError, ValueError, OSError) as error:
        where = ", ".join(f"{key} {value}" for key, value in snakemake.wildcards.items())
        with contextlib.suppress(OSError):
            traceback.print_exc(file=log)
        print(f"error in {snakemake.rule} ({where}): {error}", file=sys.stderr)
        sys.exit(1)
