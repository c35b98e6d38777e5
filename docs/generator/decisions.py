"""The index of the decisions, by topic: ``python -m docs.generator.decisions > docs/decisions/index.md``."""

import re
from dataclasses import dataclass
from pathlib import Path

#: Topics in the order of the index, each with what it is about.
TOPICS = {
    "measurements": "Reading frames and forces, and refusing what cannot be a measurement",
    "pictures": "Pictures of virtual sheets, and what image correlation makes of them",
    "noise": "How uncertain displacements and forces are",
    "laws": "Energies of sheets",
    "finite elements": "Assembly, factors and solvers",
    "identification": "From displacements and forces to a field of coefficients",
    "networks": "Hyper-networks, neural ODEs and the methods of the paper",
    "judgement": "Whether a result is right: verdicts, phases, comparisons",
    "results and records": "Files that a run leaves, and where they came from",
    "workflow and machines": "Jobs, their time and memory, compilers, clusters",
    "the house": "Packages, dependencies, documentation",
}
_STATUS = re.compile(
    r"Status: (?:accepted|superseded(?P<part> in part)? by (?P<by>[\d, ]+))\. Topic: (?P<topic>[a-z ]+)\."
    r"(?: Supersedes: (?P<whole>[\d, ]+)\.)?(?: Supersedes in part: (?P<parts>[\d, ]+)\.)?"
)


@dataclass(frozen=True, kw_only=True)
class Decision:
    """A file of a decision.

    Attributes:
        name: of the file.
        number, title: from its first line, ``# N. Title``.
        topic: one of :data:`TOPICS`.
        by: number of each decision that supersedes it, and whether only a part of it.
        over: number of each decision that it supersedes, and whether only a part of that.
    """

    name: str
    number: int
    title: str
    topic: str
    by: dict[int, bool]
    over: dict[int, bool]


def read(path: Path) -> Decision:
    """One decision.

    Raises:
        ValueError: its first line is not ``# N. Title``, or its third says no status and topic.
    """
    number = int(path.name[:4])
    first, _, third, *_ = [*path.read_text(encoding="utf-8").splitlines(), "", "", ""]
    title = first.removeprefix(f"# {number}. ")
    if title == first:
        raise ValueError(f"{path.name}: begins with {first!r} and not with '# {number}. Title'")
    said = _STATUS.fullmatch(third)
    if said is None or said["topic"] not in TOPICS:
        raise ValueError(
            f"{path.name}: line 3 is {third!r}; write 'Status: accepted. Topic: T.' with T one of {', '.join(TOPICS)}; "
            "docs/decisions/index.md shows the other forms"
        )
    over = dict.fromkeys(_numbers(said["whole"]), False) | dict.fromkeys(_numbers(said["parts"]), True)
    by = dict.fromkeys(_numbers(said["by"]), bool(said["part"]))
    return Decision(name=path.name, number=number, title=title, topic=said["topic"], by=by, over=over)


def _numbers(text: str | None) -> list[int]:
    return [int(each) for each in (text or "").split(", ") if each]


def decisions(folder: Path) -> list[Decision]:
    """Every decision, in the order of their numbers.

    Args:
        folder: with files ``NNNN-words.md``.

    Raises:
        ValueError: a file is not as :func:`read` wants it, two have one number, or a decision says that it is
            superseded and the other one does not, or the other way round.
    """
    found: dict[int, Decision] = {}
    for path in sorted(folder.glob("[0-9]*.md")):
        each = read(path)
        if each.number in found:
            raise ValueError(f"{each.name} and {found[each.number].name} have one number")
        found[each.number] = each
    by = {(old.number, new, part) for old in found.values() for new, part in old.by.items()}
    over = {(old, new.number, part) for new in found.values() for old, part in new.over.items()}
    if odd := sorted(by ^ over):
        old, new, _ = odd[0]
        raise ValueError(f"{old:04d} and {new:04d} do not agree that the second supersedes the first, or a part of it")
    return list(found.values())


def page(folder: Path) -> str:
    """The index: a table a topic, with the status of each decision.

    Args:
        folder: as for :func:`decisions`, which says what is raised.
    """
    lines = [
        *("# Decisions", "", "Why things are as they are, with what was measured and what was tried and left."),
        "The third line of a decision has its status and its topic:",
        *("", "```text", "Status: accepted. Topic: noise. Supersedes: 0034. Supersedes in part: 0043, 0060."),
        "Status: superseded in part by 0043, 0060. Topic: noise.",
        *("Status: superseded by 0043. Topic: noise.", "```"),
    ]
    found = decisions(folder)
    for topic, about in TOPICS.items():
        lines += ["", f"## {topic.capitalize()}", "", f"{about}.", "", "| | decision | status |", "|---|---|---|"]
        for each in found:
            if each.topic == topic:
                lines.append(f"| {each.number} | [{each.title}]({each.name}) | {_status(each.by)} |")
    return "\n".join([*lines, ""])


def _status(by: dict[int, bool]) -> str:
    if not by:
        return "accepted"
    return f"superseded {'in part ' * any(by.values())}by {', '.join(map(str, by))}"


def menu(folder: Path) -> str:
    """What the site adds to the index: its table of contents."""
    names = [each.name.removesuffix(".md") for each in decisions(folder)]
    return "\n".join(["", "```{toctree}", ":hidden:", "", *names, "```", ""])


if __name__ == "__main__":
    print(page(Path(__file__).resolve().parents[1] / "decisions"), end="")
