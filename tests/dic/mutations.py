"""Seeded damage to a file, as disks, editors and spreadsheets do it."""

import re

import numpy as np

#: What may get into a file.
INSERTED = [b"some text", b"\n", b";", b",", b"\t", b"\0", b"#", b"9" * 400]
#: What may stand in the place of a number.
TOKENS = [b"", b"nan", b"-inf", b"1e400", b"1e15", b"-7", b"0", b"1,5", b"1.2.3", b"--", b'"', b"1_0", b"\xb5", b"text"]


def _flipped(random, content):
    at = random.integers(len(content))
    return content[:at] + bytes([content[at] ^ (1 << random.integers(8))]) + content[at + 1 :]


def _lines(change):
    def apply(random, content):
        lines = content.split(b"\n")
        return b"\n".join(change(random, lines, int(random.integers(len(lines)))))

    return apply


def _columns_swapped(random, content):
    """Two cells of every line."""
    sign = max(b",;\t ", key=content.count)
    lines = [line.split(bytes([sign])) for line in content.split(b"\n")]
    a, b = random.integers(max(map(len, lines)), size=2)
    for cells in lines:
        if max(a, b) < len(cells):
            cells[a], cells[b] = cells[b], cells[a]
    return b"\n".join(bytes([sign]).join(cells) for cells in lines)


def _number_replaced(random, content):
    numbers = list(re.finditer(rb"\d+(\.\d+)?", content))
    chosen = numbers[random.integers(len(numbers))]
    return content[: chosen.start()] + TOKENS[random.integers(len(TOKENS))] + content[chosen.end() :]


def _inserted(random, content):
    at = random.integers(len(content) + 1)
    return content[:at] + INSERTED[random.integers(len(INSERTED))] + content[at:]


MUTATIONS = (
    _flipped,
    _lines(lambda random, lines, at: [*lines[:at], *lines[at + 1 :]]),
    _lines(lambda random, lines, at: [*lines[:at], *lines[at:][:1], *lines[at:]]),
    _lines(lambda random, lines, at: [*lines[at:], *lines[:at]]),
    _columns_swapped,
    _number_replaced,
    _number_replaced,
    _inserted,
    lambda random, content: content[: random.integers(len(content))],
)


def mutated(random: np.random.Generator, content: bytes) -> bytes:
    """The content after one to three mutations."""
    for _ in range(random.integers(1, 4)):
        if re.search(rb"\d", content):
            content = MUTATIONS[random.integers(len(MUTATIONS))](random, content)
    return content
