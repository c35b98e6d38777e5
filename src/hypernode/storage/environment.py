"""What around the code can change a number: packages, compiler, precision, processor."""

import hashlib
import importlib.metadata
import os
import platform
import re
from functools import cache
from pathlib import Path

from hypernode.installation import project_folder
from hypernode.storage.errors import StorageError

REQUIREMENTS = (project_folder() or Path()) / "requirements.txt"
#: They run jobs, describe files and colour text; no number passes through them. What is new is recorded by default.
NOT_COMPUTING = frozenset({"snakemake", "rocrate", "pygments"})
#: What a job sets, before JAX is imported, that changes how and in which precision it computes.
COMPILER_VARIABLES = ("XLA_FLAGS", "JAX_ENABLE_X64", "JAX_PLATFORMS")


@cache
def versions() -> dict[str, str]:
    """Installed versions of the packages in requirements.txt that take part in computing.

    Raises:
        StorageError: there is no requirements.txt beside the code.
    """
    try:
        lines = REQUIREMENTS.read_text(encoding="utf-8").splitlines()
    except OSError:
        raise StorageError(f"{REQUIREMENTS}: cannot be read; install the project with pip install -e .") from None
    names = [found[0] for line in lines if (found := re.match(r"[A-Za-z0-9][\w.-]*", line))]
    found = {}
    for name in names:
        try:
            version = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
        if name.lower() not in NOT_COMPUTING:
            found[name] = version
    return found


def compiler() -> dict[str, str]:
    """Flags and precision of this process, as its job has set them. Variables that are not set are left out."""
    return {name: os.environ[name] for name in COMPILER_VARIABLES if name in os.environ}


@cache
def processor() -> dict[str, str]:
    """Architecture and model name of the processor; the model is empty where the system does not tell."""
    return {"architecture": platform.machine(), "model": _cpuinfo("model name") or platform.processor()}


@cache
def instruction_set() -> str:
    """Digest of the instructions that the processor has; of its name where the system does not list them."""
    instructions = _cpuinfo("flags") or _cpuinfo("Features")
    named = " ".join(sorted(instructions.split())) or " ".join(processor().values())
    return hashlib.sha256(named.encode()).hexdigest()[:12]


def _cpuinfo(key: str) -> str:
    """What Linux says about the first processor, empty where it does not."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
    found = re.search(rf"^{key}\s*:\s*(.+)$", text, re.MULTILINE)
    return found[1].strip() if found else ""
