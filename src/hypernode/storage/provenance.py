"""Which code, settings and environment a file came from."""

import ast
import hashlib
import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from hypernode.storage.environment import compiler, versions

PACKAGE = Path(__file__).resolve().parents[1]
#: Parts of a statement that hold further ones.
_BODIES = ("body", "orelse", "finalbody", "handlers", "cases")


def _statements(tree: ast.Module) -> Iterator[ast.AST]:
    """Every statement of a module, however deep: imports are statements, and expressions are most of a tree."""
    todo: list[ast.AST] = [tree]
    while todo:
        node = todo.pop()
        yield node
        for name in _BODIES:
            todo.extend(getattr(node, name, ()))


@cache
def imported_modules(source: Path) -> frozenset[Path]:
    """Modules of this package that a Python file imports, anywhere in it, directly or not."""
    found = set()
    for node in _statements(ast.parse(source.read_text(encoding="utf-8"))):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            names = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        for name in names:
            parts = name.split(".")
            if parts[0] != PACKAGE.name:
                continue
            for candidate in (
                PACKAGE.joinpath(*parts[1:]).with_suffix(".py"),
                PACKAGE.joinpath(*parts[1:], "__init__.py"),
            ):
                if candidate.is_file():
                    found.add(candidate)
    return frozenset(found)


def modules_used(script: Path) -> list[Path]:
    """A script and every module of the package that it reaches, in a fixed order."""
    reached, todo = set(), [Path(script).resolve()]
    while todo:
        path = todo.pop()
        if path not in reached:
            reached.add(path)
            todo.extend(imported_modules(path))
    return sorted(reached)


def data_read(modules: list[Path]) -> list[Path]:
    """Files in folders without modules beside some modules: what a package brings along to read, in a fixed order."""
    return sorted(path for folder in {module.parent for module in modules} for path in _brought_along(folder))


@cache
def _brought_along(parent: Path) -> tuple[Path, ...]:
    """Files in the folders of a folder that hold no module."""
    folders = (folder for folder in parent.iterdir() if folder.is_dir() and folder.name != "__pycache__")
    kept = (folder for folder in folders if not any(folder.rglob("*.py")))
    return tuple(path for folder in kept for path in folder.rglob("*") if path.is_file())


def code_hash(script: str | Path) -> str:
    """SHA-256 over the script, every module of the package that it imports, and the files that those bring along."""
    digest = hashlib.sha256()
    modules = modules_used(Path(script))
    for path in [*modules, *data_read(modules)]:
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def describe(rule: str, wildcards: dict, settings, code: str) -> dict:
    """Attributes of a result file: rule, wildcards, settings, code, versions of packages, flags of the compiler.

    All of them stand in the file itself: two machines that agree in them are expected to agree in the result.
    """
    return {
        "rule": rule,
        "run": dict(wildcards),
        "settings": json.dumps(settings, sort_keys=True),
        "code": code,
        "versions": versions(),
        "compiler": compiler(),
    }
