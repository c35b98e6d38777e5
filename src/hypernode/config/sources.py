"""Where a configuration comes from: YAML files and the command line, merged, each value with its file and line."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from pathlib import Path

from ruamel.yaml import YAML
from ruamel.yaml.constructor import DuplicateKeyError
from ruamel.yaml.error import YAMLError
from ruamel.yaml.nodes import MappingNode, Node, SequenceNode

from hypernode.config.errors import ConfigError
from hypernode.config.merging import deep_merge


@dataclass(frozen=True)
class Source:
    """One file, or the command line: its name in messages, what it says, and its YAML nodes if it has lines."""

    name: str
    content: object
    root: Node | None = None

    def find(self, path: Sequence) -> tuple[int, int | None]:
        """(how many parts of a key path there are, line of the last of them, from 1, if it has one)."""
        depth, line, value, node = 0, None, self.content, self.root
        for part in path:
            if not _holds(value, part):
                break
            depth, value = depth + 1, value[part]
            key, node = _child(node, part)
            line = key.start_mark.line + 1 if key else line
        return depth, line


def _holds(value, part) -> bool:
    if isinstance(value, dict):
        return part in value
    return isinstance(value, list) and isinstance(part, int) and part < len(value)


def _child(node: Node | None, part) -> tuple[Node | None, Node | None]:
    """(node that marks the place of an entry, node of its value)."""
    if isinstance(node, MappingNode):
        # What '<<' merges in comes before the mapping's own keys, which override it: the last one counts.
        return next(((k, v) for k, v in reversed(node.value) if k.value == str(part)), (None, None))
    if isinstance(node, SequenceNode):
        return node.value[part], node.value[part]
    return None, None


@dataclass(frozen=True)
class Sources:
    """Sources of which each is laid over those before it."""

    parts: tuple[Source, ...]

    def merged(self) -> dict:
        """What they say together.

        Raises:
            ConfigError: one of them is no mapping.
        """
        for part in self.parts:
            if not isinstance(part.content, dict):
                kind = type(part.content).__name__
                raise ConfigError(f"{part.name}: the configuration must be a mapping of sections, not {kind}")
        return reduce(deep_merge, (part.content for part in self.parts))

    def place(self, *paths: Sequence) -> tuple[Sequence, str]:
        """(which of some key paths is written down to the greatest depth, 'file:line' of it).

        Of equal depths the first path counts, and in it the last source.
        """
        found = [(part.find(path), path, part.name) for path in paths for part in reversed(self.parts)]
        (_, line), path, name = max(found, key=lambda each: each[0][0])
        return path, f"{name}:{line}" if line else name

    def where(self, *path) -> str:
        """'file:line' of a key path, as deep as it is written."""
        return self.place(path)[1]


def read_yaml(path: str | Path) -> Source:
    """Read a YAML 1.2 file.

    Raises:
        ConfigError: it cannot be read, is not YAML, or has a key twice.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: cannot be read: {error}") from None
    yaml = YAML(typ="safe", pure=True)
    try:
        root = yaml.compose(text)
        content = yaml.constructor.construct_document(root) if root else None
    except (YAMLError, RecursionError, TypeError, ValueError) as error:
        mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
        line = f":{mark.line + 1}" if mark else ""
        problem = getattr(error, "problem", None) or error
        if isinstance(error, DuplicateKeyError):
            problem = f"{str(problem).split(' with value')[0].replace('found duplicate', 'the')} is written twice"
        raise ConfigError(f"{path}{line}: not valid YAML: {problem}") from None
    return Source(str(path), content, root)
