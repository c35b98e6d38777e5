"""What the workflow asks of Snakemake's scheduler that no profile can say (docs/decisions/0028).

Both requests reach into the running Snakemake. A version that has no such thing goes on without it.
"""

import os
from pathlib import Path

#: Of the memory of a machine, what jobs may have; the rest is the system's and Snakemake's.
SHARE = 0.9
_CGROUP_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")


def machine_memory() -> int:
    """Memory of this machine, or of the control group that this process may use of it [MB]."""
    known = [os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")]
    for path in map(Path, _CGROUP_LIMITS):
        if path.is_file() and (text := path.read_text().strip()).isdigit():
            known.append(int(text))
    return min(known) // 10**6


def limit_memory(workflow) -> None:
    """Let jobs that run side by side on this machine declare no more memory than it has.

    ``--resources mem_mb=...`` has the last word. A job that needs more than all runs alone. On a cluster, whose
    jobs are not on this machine, there is no limit. Call it where the Snakefile is read.

    Args:
        workflow: Snakemake's.
    """
    here = getattr(workflow, "is_main_process", False) and getattr(workflow, "nodes", None) is None
    register = getattr(workflow, "register_resource", None)
    if here and register and "mem_mb" not in getattr(workflow, "global_resources", {}):
        register("mem_mb", int(SHARE * machine_memory()))


def lift_rate_limit(workflow) -> None:
    """Take away the limit of submissions a second where jobs run on this machine. Call it when the run starts.

    With the limit, the scheduler wakes once a second for every job that has ever ended: after hundreds of jobs, a
    large share of a core. No option takes it away: a longer span of time makes Snakemake wait that long at its end.

    Args:
        workflow: Snakemake's.
    """
    scheduler = getattr(workflow, "scheduler", None)
    if getattr(workflow, "local_exec", False) and hasattr(scheduler, "job_rate_limiter"):
        scheduler.job_rate_limiter = None
