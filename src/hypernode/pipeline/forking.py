"""Jobs begin as copies of one process that has imported what they need (docs/decisions/0054).

An interpreter, JAX and the modules of a stage take more than a second, the same for every job. So a run starts one
process that imports all of it and forks for each job. A copy has the environment and the folder of its job, is
measured as the job, and ends as it ends. The process that is copied computes nothing, so that nothing of one job
reaches another.
"""

import atexit
import contextlib
import gc
import json
import os
import runpy
import selectors
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager
from importlib import import_module
from pathlib import Path

from hypernode.pipeline.compiler import set_up_compiler
from hypernode.pipeline.job import die_with_parent
from hypernode.storage.provenance import PACKAGE, modules_used

#: Fewer jobs import what they need by themselves sooner than one process imports everything for all.
FEWEST_JOBS = 4
#: What libraries of linear algebra, which choose their threads when they are imported, read their number from.
THREADS = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "GOTO_NUM_THREADS"), "1")
#: Environment variable; set to 0, every job is a process of its own from its beginning.
SWITCH = "HYPERNODE_FORK"
#: Bytes of the longest request: a script and the environment of its job.
_LONGEST = 1 << 20


def serve(control: socket.socket) -> dict | None:
    """Fork for every request, until there are no more.

    Args:
        control: where requests come from, each with a pipe. Into that go the number of the copy when it begins, and its
            exit status when it has ended, a line each.

    Returns:
        In a copy what it is to do; None in the process that is copied.
    """
    running: dict[int, tuple[int, int]] = {}
    with selectors.DefaultSelector() as ready:
        ready.register(control, selectors.EVENT_READ)
        while True:
            for key, _ in ready.select():
                if key.fileobj is not control:
                    ready.unregister(key.fd)
                    _tell_end(key.fd, *running.pop(key.fd))
                    continue
                request, pipes, *_ = socket.recv_fds(control, _LONGEST, 1)
                if not request:
                    return None
                pid = os.fork()
                if pid == 0:
                    for file in (*pipes, *running, *(pipe for _, pipe in running.values())):
                        os.close(file)
                    control.close()
                    return json.loads(request)
                ended = os.pidfd_open(pid)
                running[ended] = pid, pipes[0]
                ready.register(ended, selectors.EVENT_READ)
                _tell(pipes[0], pid)


def _tell(pipe: int, number: int) -> None:
    # Nobody listens any more where a run was interrupted.
    with contextlib.suppress(OSError):
        os.write(pipe, f"{number}\n".encode())


def _tell_end(ended: int, pid: int, pipe: int) -> None:
    _, status = os.waitpid(pid, 0)
    _tell(pipe, os.waitstatus_to_exitcode(status))
    os.close(ended)
    os.close(pipe)


def main(descriptor: str, *modules: str) -> None:
    """Import modules and be copied; a copy runs its script and ends as that does.

    Args:
        descriptor: number of the socket that requests come from.
        modules: what to import; what cannot be imported is left to the jobs.
    """
    die_with_parent()
    # Who presses Ctrl-C means the jobs: this process ends with the one that has started it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    control = socket.socket(fileno=int(descriptor))
    set_up_compiler(float64=False)
    for module in modules:
        with contextlib.suppress(ImportError):
            import_module(module)
    if len(os.listdir("/proc/self/task")) > 1:
        # What is imported has begun threads, which a copy would not have.
        return
    gc.collect()
    gc.freeze()
    asked = serve(control)
    if asked is not None:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        os.environ.clear()
        os.environ.update(asked["environment"])
        os.chdir(asked["folder"])
        sys.argv = [asked["script"]]
        runpy.run_path(asked["script"], run_name="__main__")


class ForkServer:
    """The process that jobs are copies of, as whoever starts it sees it.

    Args:
        modules: what it imports.
    """

    def __init__(self, modules: Iterable[str]):
        self._control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            line = [sys.executable, "-P", "-m", __name__, str(theirs.fileno()), *modules]
            environment = {**os.environ, **THREADS}
            self._process = subprocess.Popen(line, pass_fds=[theirs.fileno()], env=environment)  # noqa: S603 - ours

    def run(
        self,
        script: str,
        environment: Mapping[str, str],
        watched: Callable[[int], AbstractContextManager] = contextlib.nullcontext,
    ) -> int | None:
        """The exit status of a script, negative where a signal ended it; None where no copy could be made for it.

        Args:
            script: path.
            environment: variables that it sees.
            watched: what to enter with the number of its process while it runs.
        """
        request = {"script": os.path.abspath(script), "folder": os.getcwd(), "environment": dict(environment)}
        reading, writing = os.pipe()
        with os.fdopen(reading) as answers:
            try:
                socket.send_fds(self._control, [json.dumps(request).encode()], [writing])
            except OSError:
                return None
            finally:
                os.close(writing)
            begun = answers.readline()
            if not begun:
                return None
            with watched(int(begun)):
                ended = answers.readline()
        # The process that is copied takes its copies with it when it is killed.
        return int(ended) if ended else -signal.SIGKILL

    def close(self) -> None:
        """End the process."""
        self._control.close()
        self._process.wait()


def modules_of(scripts: Iterable[Path]) -> list[str]:
    """Names of all modules of the package that some scripts reach, in a fixed order."""
    paths = {path for script in scripts for path in modules_used(script) if path.is_relative_to(PACKAGE)}
    names = (path.relative_to(PACKAGE.parent).with_suffix("").parts for path in paths)
    return sorted({".".join(parts).removesuffix(".__init__") for parts in names})


def fork_jobs(workflow, scripts: Path) -> None:
    """Let the scripts of this run begin as copies of one process. Call it when the run starts.

    Only where jobs run on this machine, with one thread and in the environment of Snakemake. Reaches into the running
    Snakemake: a version that has no such things goes on without it.

    Args:
        workflow: Snakemake's.
        scripts: folder with a script of the name of every rule.
    """
    here = getattr(workflow, "local_exec", False) and hasattr(os, "pidfd_open")
    if not here or os.environ.get(SWITCH) == "0":
        return
    try:
        from snakemake.benchmark import benchmarked
        from snakemake.script import PythonScript

        planned = [scripts / f"{job.rule.name}.py" for job in workflow.dag.needrun_jobs()]
        plainly = PythonScript.execute_script
    except (ImportError, AttributeError):
        return
    planned = [script for script in planned if script.is_file()]
    if len(planned) < FEWEST_JOBS:
        return
    server = ForkServer(modules_of(dict.fromkeys(planned)))
    atexit.register(server.close)

    def execute_script(self, fname, edit=False):
        """As Snakemake's own, without a new interpreter."""
        status = None
        if not (self.conda_env or self.container_img or self.env_modules or self.shadow_dir) and self.threads == 1:
            record = self.bench_record
            watched = contextlib.nullcontext if record is None else lambda pid: benchmarked(pid, record)
            folder = self.resources.get("tmpdir")
            temporary = dict.fromkeys(("TMPDIR", "TMP", "TEMPDIR", "TEMP"), folder) if folder else {}
            status = server.run(fname, {**os.environ, **THREADS, **temporary}, watched)
        if status is None:
            plainly(self, fname, edit)
        elif status:
            raise subprocess.CalledProcessError(status, f"{sys.executable} {fname}")

    PythonScript.execute_script = execute_script


if __name__ == "__main__":
    main(*sys.argv[1:])
