"""One sheet of a study in a process of its own, with one core, so that sheets side by side share the machine."""

import json
import os
import subprocess
import sys
from pathlib import Path

from benchmarks.strangers.one import ROOT


def scored(module: str, arguments: list[str], folder: Path) -> dict | str:
    """The score in a folder, or in words why there is none; runs the module where there is none yet.

    Args:
        module: what writes ``score.json``; it is given the arguments, the folder among them.
    """
    file = folder / "score.json"
    if not file.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        environment = os.environ | {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")}
        environment.setdefault("HYPERNODE_CACHE", str(folder.resolve().parent / "compiled"))
        command = [sys.executable, "-m", module, *arguments]
        done = subprocess.run(command, cwd=ROOT, env=environment, stderr=subprocess.PIPE, text=True)
        if not file.is_file():
            said = done.stderr.strip().splitlines()
            return said[-1] if said else f"ended with code {done.returncode}"
    return json.loads(file.read_text())
