"""A copy of the repository in which blocks run, its configuration and its presets of a size of seconds."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import yaml

from hypernode.config.merging import deep_merge

ROOT = Path(__file__).resolve().parents[2]
SMALL = yaml.safe_load((Path(__file__).parent / "small.yaml").read_text(encoding="utf-8"))
#: What is no part of the project's sources.
_OTHER = (
    ".git",
    ".venv*",
    ".cache",
    ".snakemake",
    "results",
    "experiments",
    "site",
    "__pycache__",
    "*.egg-info",
    ".*_cache",
)
#: A run of few iterations may fail, which is exit code 1; that it ends with a verdict is what is expected of it.
_HYPERNODE = """#!/usr/bin/env bash
"{real}" "$@"
code=$?
case "$1" in identify | verdict) [ $code -eq 1 ] && exit 0 ;; esac
exit $code
"""


class Copy:
    """A folder in which blocks run as they would in the repository."""

    def __init__(self, folder: Path, cache: Path):
        self.folder = folder
        shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*_OTHER), dirs_exist_ok=True)
        self._make_small()
        own, here = folder / ".venv", Path(sys.prefix)
        (own / "bin").mkdir(parents=True)
        for program in (here / "bin").iterdir():
            (own / "bin" / program.name).symlink_to(program)
        # With these, the Python of a link finds the packages of the environment that it belongs to.
        (own / "lib").symlink_to(here / "lib")
        shutil.copyfile(here / "pyvenv.cfg", own / "pyvenv.cfg")
        wrapped = own / "bin" / "hypernode"
        wrapped.unlink(missing_ok=True)
        wrapped.write_text(_HYPERNODE.format(real=here / "bin/hypernode"), encoding="utf-8")
        wrapped.chmod(0o755)
        # What make takes for an environment that is built.
        for mark in ("run", "dev"):
            (own / mark).touch()
        self.variables = {**os.environ, "HYPERNODE_CACHE": str(cache)}
        self.variables |= {"PYTHONPATH": str(folder / "src"), "HYPERNODE_SOURCE": str(folder / "src")}
        self.variables["PATH"] = f"{own / 'bin'}:{os.environ['PATH']}"

    def _make_small(self) -> None:
        presets = self.folder / "src/hypernode/config/presets.yaml"
        own = yaml.safe_load(presets.read_text(encoding="utf-8"))
        presets.write_text(yaml.safe_dump(deep_merge(own, SMALL["presets"])), encoding="utf-8")
        config = self.folder / "config/config.yaml"
        whole = yaml.safe_load(config.read_text(encoding="utf-8"))
        kept = {section: entries for section, entries in whole.items() if section not in SMALL["config"]}
        config.write_text(yaml.safe_dump(kept | SMALL["config"]), encoding="utf-8")

    def run(self, language: str, code: str) -> subprocess.CompletedProcess:
        """Run a block as a reader would, who stops at the first command that fails."""
        command = ["bash", "-euo", "pipefail", "-c", code] if language == "sh" else ["python", "-c", code]
        return subprocess.run(
            command, cwd=self.folder, capture_output=True, text=True, env=self.variables, stdin=subprocess.DEVNULL
        )
