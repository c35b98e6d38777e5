"""Which CPUs one job computes on, so that jobs side by side do not fight over them."""

import contextlib
import os
import socket


@contextlib.contextmanager
def claimed_cores(count: int, scope: str | None = None):
    """Pin this process to ``count`` CPUs that no other job of this user on this machine has claimed.

    XLA sizes its pool of threads by the CPUs of the process, so enter this before JAX is imported. A claim is a socket
    whose name, without a file, is known to the whole machine, whatever folder each job has for temporary files. The
    kernel drops it when the process ends, however it ends. Where too few CPUs are free, or the system knows no such
    names, the rest are taken by the number of the process and may be shared: slower, equally right.

    Args:
        count: CPUs to compute on; at most those that the process was given.
        scope: claims of different scopes do not know of one another; by default there is one a user.

    Yields:
        The numbers of the CPUs. At the end the process has those again that it came with.
    """
    scope = scope or f"hypernode-{os.getuid()}"
    allowed = sorted(os.sched_getaffinity(0))
    with contextlib.ExitStack() as claims:
        chosen = []
        for cpu in allowed:
            if len(chosen) == count:
                break
            with contextlib.suppress(OSError):
                claim = claims.enter_context(socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM))
                claim.bind(f"\0{scope}-cpu{cpu}")
                chosen.append(cpu)
        spare = [cpu for cpu in allowed if cpu not in chosen]
        start = os.getpid() % max(len(spare), 1)
        chosen += (spare[start:] + spare[:start])[: count - len(chosen)]
        os.sched_setaffinity(0, chosen)
        try:
            yield chosen
        finally:
            os.sched_setaffinity(0, allowed)
