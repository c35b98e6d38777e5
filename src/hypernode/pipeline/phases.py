"""What a job spends its time on: JAX traces and compiles, and the rest computes, reads and writes.

Only a job that begins as a copy of one process (:mod:`hypernode.pipeline.forking`) is told apart so: elsewhere JAX is
imported later than a job could listen to it.
"""

import sys
import time

#: Last part of the name of an event of JAX -> what it belongs to.
EVENTS = {
    "jaxpr_trace_duration": "tracing",
    "jaxpr_to_mlir_module_duration": "tracing",
    "backend_compile_duration": "compilation",
}


class Phases:
    """Seconds by the clock since a job began, by what they were for."""

    def __init__(self):
        self._begun = time.monotonic()
        self._spans: list[tuple[float, float, str]] = []

    def listen(self) -> "Phases":
        """Hear what JAX tells, which must have been imported."""
        sys.modules["jax"].monitoring.register_event_duration_secs_listener(self.heard)
        return self

    def heard(self, event: str, duration: float, **_) -> None:
        """Note that something has just ended that took ``duration`` seconds.

        One that was traced or compiled meanwhile, as part of it, is not counted twice.
        """
        name = EVENTS.get(event.rsplit("/", 1)[-1])
        if name is None:
            return
        begun = time.monotonic() - duration
        while self._spans and self._spans[-1][0] >= begun:
            self._spans.pop()
        self._spans.append((begun, duration, name))

    def seconds(self) -> dict[str, float]:
        """Seconds of ``tracing``, ``compilation`` and ``rest`` so far."""
        total = dict.fromkeys(EVENTS.values(), 0.0)
        for _, duration, name in self._spans:
            total[name] += duration
        return total | {"rest": max(0.0, time.monotonic() - self._begun - sum(total.values()))}

    def line(self) -> str:
        """The seconds as a line of a log, which :func:`read_line` reads."""
        return "seconds of this job: " + ", ".join(f"{name} {value:.2f}" for name, value in self.seconds().items())


def read_line(log: str) -> dict[str, float] | None:
    """What :meth:`Phases.line` says in the text of a log, or None where nothing does: the last where several do."""
    lines = [line for line in log.splitlines() if line.startswith("seconds of this job: ")]
    if not lines:
        return None
    parts = (part.rsplit(" ", 1) for part in lines[-1].split(": ", 1)[1].split(", "))
    return {name: float(value) for name, value in parts}
