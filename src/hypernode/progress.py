"""Progress lines on standard error: stage, case, step, numbers, time left.

They are records of the logger ``hypernode``. ``HYPERNODE_LOG`` sets its level, ``info`` by default. The level ``debug``
shows every step of a loop, ``warning`` none. A program that imports the package may use :mod:`logging` as usual.
"""

import logging
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

#: Environment variable with the level, which jobs of a run inherit.
LEVEL = "HYPERNODE_LOG"
#: What it may be.
LEVELS = ("debug", "info", "warning")
LOG = logging.getLogger("hypernode")


class _StandardError(logging.Handler):
    """Writes to what is standard error at that moment."""

    def emit(self, record: logging.LogRecord) -> None:
        print(self.format(record), file=sys.stderr, flush=True)


class _Texts(logging.Handler):
    """Keeps what is said of a case, without stage and case."""

    def __init__(self):
        super().__init__()
        self.texts: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.texts.append(record.args["text"])


def set_level() -> None:
    """Set the level that ``HYPERNODE_LOG`` names; an unknown name counts as ``info``."""
    named = os.environ.get(LEVEL, "info").lower()
    LOG.setLevel((named if named in LEVELS else "info").upper())


if not LOG.handlers:
    LOG.addHandler(_StandardError())
    LOG.propagate = False
    set_level()


def say(stage: str, case: str, text: str, level: int = logging.INFO) -> None:
    """One line about a stage of a case."""
    LOG.log(level, "[%(stage)s] %(case)s: %(text)s", {"stage": stage, "case": case, "text": text})


@contextmanager
def heard() -> Iterator[list[str]]:
    """What is said meanwhile, as texts in a list, and not on standard error."""
    handlers, level, listener = LOG.handlers, LOG.level, _Texts()
    LOG.handlers = [listener]
    LOG.setLevel(logging.INFO)
    try:
        yield listener.texts
    finally:
        LOG.handlers = handlers
        LOG.setLevel(level)


class Progress:
    """Says a line at most every few seconds, and one at the end; at the level ``debug`` one for every step.

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
        due = self.step >= self.total or now - self.last >= self.every
        if not (due or LOG.isEnabledFor(logging.DEBUG)):
            return
        if due:
            self.last = now
        left = (now - self.start) / max(self.step, 1) * (self.total - self.step)
        shown = [f"{key} {value:.3g}" for key, value in numbers.items()]
        text = ", ".join([f"step {self.step}/{self.total}", *shown, f"{left:.0f} s left"])
        say(self.stage, self.case, text, logging.INFO if due else logging.DEBUG)
