"""How one job of the workflow runs: its cores, its log, its errors, its attributes.

This module must be imported before JAX: it pins the process to as many CPUs as the job declares, so
that XLA's thread pool has that size and two jobs on two cores do not fight.
"""

import contextlib
import ctypes
import fcntl
import importlib.metadata
import os
import signal
import sys
import tempfile
import traceback
from pathlib import Path

from hypernode.errors import ExpectedError
from hypernode.storage.provenance import describe

_PR_SET_PDEATHSIG = 1
#: XLA's older emitters of CPU kernels (docs/decisions/0016).
QUICK_KERNELS = "--xla_cpu_use_fusion_emitters=false"
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


def set_up_compiler(float64: bool) -> None:
    """Compile quickly, and keep what is compiled between jobs, outside results/ and safe to delete at any time.

    Call it before JAX is imported, which many jobs never do. Where ``XLA_FLAGS`` is set, it has the last word.

    Args:
        float64: whether JAX computes in double precision.
    """
    folder = Path(os.environ.get("HYPERNODE_CACHE", ".cache")) / f"jax-{importlib.metadata.version('jaxlib')}"
    os.environ |= {
        # A step of ours is hundreds of small kernels. The newer emitters set up a compiler of their own for each, which
        # takes longer than what they save in all but the longest training.
        "XLA_FLAGS": " ".join(filter(None, [QUICK_KERNELS, os.environ.get("XLA_FLAGS")])),
        "JAX_ENABLE_X64": str(int(float64)),
        "JAX_COMPILATION_CACHE_DIR": str(folder.resolve()),
        # Most of a job's compilation is a hundred small functions; kept, they cost a few milliseconds each.
        "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
        "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1",
    }


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
    os.environ.setdefault("JAX_PLATFORMS", "cpu")
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
