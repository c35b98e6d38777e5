"""Progress lines on standard error: stage, case, step, numbers, time left."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

#: Lists that lines go to instead of standard error; the last one listens.
_LISTENING: list[list[str]] = []


def say(stage: str, case: str, text: str) -> None:
    """One line on standard error about a stage of a case."""
    if _LISTENING:
        _LISTENING[-1].append(text)
    else:
        print(f"[{stage}] {case}: {text}", file=sys.stderr, flush=True)


@contextmanager
def heard() -> Iterator[list[str]]:
    """What is said meanwhile, as texts in a list, and not on standard error."""
    _LISTENING.append([])
    try:
        yield _LISTENING[-1]
    finally:
        _LISTENING.pop()


class Progress:
    """Prints a line at most every few seconds, and one at the end.

    Args:
        stage, case: named in every line.
        total: number of steps to come.
        every: least time between lines [s].
    """

    def __init__(self, stage: str, case: str, total: int, every: float = 3.0):
        self.stage, self.case, self.total, self.every = stage, case, total, every
        self.step, self.start, self.last = 0, time.monotonic(), 0.0

    def advance(self, steps: int = 1, **numbers: float) -> None:
        """Note that ``steps`` more are done and show the numbers."""
        self.step += steps
        now = time.monotonic()
        if self.step < self.total and now - self.last < self.every:
            return
        self.last = now
        left = (now - self.start) / max(self.step, 1) * (self.total - self.step)
        shown = ", ".join(f"{key} {value:.3g}" for key, value in numbers.items())
        say(self.stage, self.case, f"step {self.step}/{self.total}, {shown}, {left:.0f} s left")
