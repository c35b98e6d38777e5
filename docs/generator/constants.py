"""The page of the constants of an identification: ``python -m docs.generator.constants > docs/constants.md``."""

import ast
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Modules in the order of the page.
MODULES = ("thresholds", "priors", "numerics", "budgets")


@dataclass(frozen=True, kw_only=True)
class Constant:
    """A constant of a module.

    Attributes:
        name: in the module.
        value: as it is written there.
        reason: the comment above it.
        group: the comment above it and those beside it.
    """

    name: str
    value: str
    reason: str
    group: str


def constants(text: str) -> list[Constant]:
    """Every constant of a module, in the order in which they stand there.

    Raises:
        ValueError: one has no reason or stands in no group.
    """
    lines, found, group, last = text.splitlines(), [], "", 0
    for node in ast.parse(text).body:
        if isinstance(node, ast.Assign):
            above = lines[last : node.lineno - 1]
            reason = " ".join(line.removeprefix("#:").strip() for line in above if line.startswith("#:"))
            group = " ".join(line.removeprefix("#").strip() for line in above if line.startswith("# ")) or group
            name, value = ast.unparse(node.targets[0]), ast.get_source_segment(text, node.value)
            if not (reason and group):
                raise ValueError(f"{name} has {'a' if reason else 'no'} reason and {'a' if group else 'no'} group")
            found.append(Constant(name=name, value=value, reason=reason, group=group))
        last = node.end_lineno
    return found


def page(folder: Path) -> str:
    """The page: a table a module.

    Args:
        folder: of the modules.
    """
    lines = [
        *("# Constants of an identification", ""),
        "These numbers of an identification were chosen, each for a reason. Thresholds decide, and priors say what is",
        "believed without data. Numerics and budgets say how it is computed.",
    ]
    for module in MODULES:
        text = (folder / f"{module}.py").read_text(encoding="utf-8")
        about, group = ast.get_docstring(ast.parse(text)), None
        lines += ["", f"## {module.capitalize()}", "", f"`identification.{module}`: {about[0].lower()}{about[1:]}"]
        lines += ["", "| constant | value | reason |", "|---|---|---|"]
        for each in constants(text):
            if each.group != group:
                group = each.group
                lines.append(f"| | | **{group}** |")
            lines.append(f"| `{each.name}` | `{each.value}` | {each.reason} |")
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    print(page(ROOT / "src/hypernode/identification"), end="")
