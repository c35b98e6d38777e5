"""The index of the decisions."""

from pathlib import Path


def page(folder: Path) -> str:
    """A table of contents of every decision.

    Args:
        folder: with files ``NNNN-words.md``, each of which begins with ``# N. Title``.

    Raises:
        ValueError: a file begins otherwise, or two have one number.
    """
    seen = {}
    for path in sorted(folder.glob("[0-9]*.md")):
        number = int(path.name[:4])
        first = path.read_text(encoding="utf-8").splitlines()[0]
        title = first.removeprefix(f"# {number}. ")
        if title == first:
            raise ValueError(f"{path.name}: begins with {first!r} and not with '# {number}. Title'")
        if number in seen:
            raise ValueError(f"{path.name} and {seen[number]} have one number")
        seen[number] = path.name
    lines = [
        "# Decisions",
        "",
        "Why things are as they are, with what was measured.",
        "",
        "```{toctree}",
        ":maxdepth: 1",
        "",
    ]
    return "\n".join([*lines, *(name.removesuffix(".md") for name in seen.values()), "```", ""])
