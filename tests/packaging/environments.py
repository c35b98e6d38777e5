"""A wheel of the project, and new environments to install it in."""

import contextlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: What a wheel is built from, and nothing else that lies in the repository.
SOURCES = (
    *("pyproject.toml", "README.md", "LICENSE", "Snakefile", "requirements.txt", "config", "profiles", "src"),
    "workflow",
)


class Environment:
    """A virtual environment, whose commands see nothing of this one or of the repository."""

    def __init__(self, folder, python=sys.executable):
        self.bin = folder / "bin"
        subprocess.run([str(python), "-m", "venv", str(folder)], check=True)
        hidden = ("PYTHONPATH", "VIRTUAL_ENV", "HYPERNODE_CACHE")
        self.variables = {key: value for key, value in os.environ.items() if key not in hidden}
        self.variables["PATH"] = f"{self.bin}:{os.environ['PATH']}"

    def install(self, *words):
        done = self.run("pip", "install", "--quiet", "--disable-pip-version-check", *words)
        assert done.returncode == 0, done.stderr[-4000:]

    def run(self, command, *words, cwd=None):
        words = [str(self.bin / command), *map(str, words)]
        return subprocess.run(words, cwd=cwd, capture_output=True, text=True, env=self.variables)

    def python(self, code, *words, cwd=None):
        done = self.run("python", "-c", code, *words, cwd=cwd)
        assert done.returncode == 0, done.stderr[-4000:]
        return done.stdout


def build(folder):
    """A wheel from a copy of the sources: a build leaves its own files in the folder that it is made in."""
    for name in SOURCES:
        source, copy = ROOT / name, folder / "source" / name
        if source.is_dir():
            shutil.copytree(source, copy, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
        else:
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, copy)
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--disable-pip-version-check"]
    subprocess.run([*command, "-w", str(folder), str(folder / "source")], check=True)
    (wheel,) = folder.glob("*.whl")
    return wheel


@contextlib.contextmanager
def environment(folder, python=sys.executable):
    """An environment that is gone afterwards: each takes a gigabyte."""
    try:
        yield Environment(folder, python)
    finally:
        shutil.rmtree(folder)
