"""A scheduler of one machine, for tests: ``sbatch``, ``scontrol`` and ``scancel`` as far as profiles use them.

Jobs start at once, in a session of their own; one that takes more memory than it asked for is killed, as on a cluster.
Its folder, named by ``LOCAL_QUEUE``, keeps for every job what it asked for, the most that it took, and how it ended.
"""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil

COMMANDS = ("sbatch", "scontrol", "scancel")


def installed(folder: Path) -> dict[str, str]:
    """Put the commands into a folder; the environment in which they are found and keep their jobs there."""
    folder.mkdir()
    for name in COMMANDS:
        script = folder / name
        script.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{__file__}" {name} "$@"\n')
        script.chmod(0o755)
    return {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}", "LOCAL_QUEUE": str(folder)}


def jobs(folder: Path) -> list[dict]:
    """Every job that was handed in, in order."""
    return [json.loads(path.read_text()) for path in sorted(folder.glob("*.job"), key=lambda p: int(p.stem))]


def sbatch(folder: Path, *words: str) -> None:
    """Start a job that outlives this command, and print its number."""
    options = dict(word[2:].partition("=")[::2] for word in words[:-1])
    number = 1 + len(list(folder.glob("*.job")))
    said = {"name": options["job-name"], "asked": int(options["mem"][:-1]), "state": "RUNNING", "peak": 0}
    _keep(folder, number, said)
    watch = [sys.executable, __file__, "watch", str(number), options["output"].replace("%j", str(number)), words[-1]]
    subprocess.Popen(watch, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    print(number)


def watch(folder: Path, number: str, log: str, script: str) -> None:
    """Run a job, measure it and end it where it takes too much."""
    said = json.loads((folder / f"{number}.job").read_text())
    with open(log, "w") as output:
        # A node's own folder for temporary files, gone with the job.
        own = folder / f"tmp{number}"
        own.mkdir()
        job = subprocess.Popen(
            [script], stdout=output, stderr=output, start_new_session=True, env={**os.environ, "TMPDIR": str(own)}
        )
        _keep(folder, number, said | {"pid": job.pid})
        while job.poll() is None and said["peak"] <= said["asked"]:
            said["peak"] = max(said["peak"], _taken(job.pid))
            time.sleep(0.1)
    ended = "CANCELLED" if json.loads((folder / f"{number}.job").read_text())["state"] == "CANCELLED" else "FAILED"
    if job.poll() is None:
        ended = "OUT_OF_MEMORY"
        _kill(job.pid)
    _keep(folder, number, said | {"state": "COMPLETED" if job.wait() == 0 else ended})


def scontrol(folder: Path, *words: str) -> None:
    """Print the state of a job."""
    place = folder / f"{words[-1]}.job"
    if not place.is_file():
        sys.exit("slurm_load_jobs error: Invalid job id specified")
    print(f"JobId={words[-1]} JobState={json.loads(place.read_text())['state']} Reason=None")


def scancel(folder: Path, *numbers: str) -> None:
    """End some jobs."""
    for number in numbers:
        said = json.loads((folder / f"{number}.job").read_text())
        if said["state"] == "RUNNING":
            _keep(folder, number, said | {"state": "CANCELLED"})
            _kill(said["pid"])


def _keep(folder: Path, number, said: dict) -> None:
    beside = folder / f"{number}.{os.getpid()}"
    beside.write_text(json.dumps(said))
    beside.replace(folder / f"{number}.job")


def _family(pid: int) -> list[psutil.Process]:
    try:
        first = psutil.Process(pid)
        return [first, *first.children(recursive=True)]
    except psutil.NoSuchProcess:
        return []


def _taken(pid: int) -> int:
    """Memory of a job [MB]: the sum over its processes, pages that they share counted for each, as schedulers do."""
    total = 0
    for process in _family(pid):
        try:
            total += process.memory_info().rss
        except psutil.NoSuchProcess:
            continue
    return total // 10**6


def _kill(pid: int) -> None:
    for process in _family(pid):
        try:
            process.send_signal(signal.SIGKILL)
        except psutil.NoSuchProcess:
            continue


if __name__ == "__main__":
    command = {"sbatch": sbatch, "scontrol": scontrol, "scancel": scancel, "watch": watch}[sys.argv[1]]
    command(Path(os.environ["LOCAL_QUEUE"]), *sys.argv[2:])
