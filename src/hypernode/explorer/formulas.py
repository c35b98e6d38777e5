"""Formulas of scalars as numbered statements, whose text is JavaScript and Python alike.

A statement is, for example, ``a7=a3*p[2]``. It has names of earlier statements, inputs such as ``p[2]``, numbers,
arithmetic, and functions of :data:`FUNCTIONS`. Both languages call these by one name. Equal formulas are one statement,
and what is made of numbers alone is a number.
"""

import math
from collections.abc import Iterable

#: Functions of both languages' mathematics beside max, min, abs, pow and where.
FUNCTIONS = ("cos", "cosh", "exp", "expm1", "log", "log1p", "sin", "sinh", "sqrt", "tan", "tanh")
#: Operation -> its text, which is valid in both languages; a condition chooses with ``where(condition, yes, no)``.
TEXT = {
    "add": "{}+{}",
    "sub": "{}-{}",
    "mul": "{}*{}",
    "div": "{}/{}",
    "neg": "-{}",
    "max": "max({},{})",
    "min": "min({},{})",
    "pow": "pow({},{})",
    "abs": "abs({})",
    "eq": "({}=={})",
    "ne": "({}!={})",
    "ge": "({}>={})",
    "gt": "({}>{})",
    "le": "({}<={})",
    "lt": "({}<{})",
    "and": "({}&{})",
    "or": "({}|{})",
    "not": "(1-{})",
    "where": "where({},{},{})",
    **{name: f"{name}({{}})" for name in FUNCTIONS},
}
#: What the text of a number is evaluated with while numbers alone are folded.
_KNOWN = {
    **{name: getattr(math, name) for name in FUNCTIONS},
    **{"max": max, "min": min, "pow": pow, "abs": abs, "where": lambda condition, yes, no: yes if condition else no},
}


def names_of_python() -> dict:
    """The functions that the text of statements calls, for Python to evaluate it."""
    return dict(_KNOWN)


class Formulas:
    """Statements in the order in which they can be evaluated; a formula is known by its number."""

    def __init__(self):
        self._operations: list[tuple] = []
        self._known: dict[tuple, int] = {}

    def number(self, value: float) -> int:
        """A constant."""
        return self._formula("number", float(value))

    def input(self, name: str) -> int:
        """An input by its text, such as ``p[2]``."""
        return self._formula("input", name)

    def apply(self, operation: str, *arguments: int) -> int:
        """An operation of :data:`TEXT` on formulas."""
        values = [self._value(argument) for argument in arguments]
        if None not in values:
            return self.number(eval(TEXT[operation].format(*map(_literal, values)), {}, _KNOWN))  # noqa: S307
        neutral = self._neutral(operation, arguments, values)
        return self._formula(operation, *arguments) if neutral is None else neutral

    def statements(self, results: Iterable[int]) -> tuple[list[str], list[str]]:
        """(statements that are needed, text of every result)."""
        results, needed = list(results), set()
        for number in range(len(self._operations) - 1, -1, -1):
            if number in needed or number in results:
                operation, *arguments = self._operations[number]
                needed |= {number} | (set(arguments) if operation in TEXT else set())
        text, lines = {}, []
        for number in sorted(needed):
            operation, *arguments = self._operations[number]
            if operation in TEXT:
                name = f"a{len(lines)}"
                lines.append(f"{name}={TEXT[operation].format(*(text[each] for each in arguments))}")
                text[number] = name
            else:
                text[number] = _literal(arguments[0]) if operation == "number" else arguments[0]
        return lines, [text[number] for number in results]

    def _formula(self, *operation) -> int:
        if operation not in self._known:
            self._known[operation] = len(self._operations)
            self._operations.append(operation)
        return self._known[operation]

    def _value(self, number: int) -> float | None:
        operation, *rest = self._operations[number]
        return rest[0] if operation == "number" else None

    def _neutral(self, operation: str, arguments, values) -> int | None:
        """The formula itself where a zero or a one changes nothing; zero where it takes everything away."""
        for one, other in ((0, 1), (1, 0)) if operation in ("add", "mul") else ((0, 1),):
            value = values[other] if len(values) == 2 else None
            if (operation in ("add", "sub") and value == 0.0) or (operation in ("mul", "div") and value == 1.0):
                return arguments[one]
        return self.number(0.0) if operation == "mul" and 0.0 in values else None


def _literal(value: float) -> str:
    """A number as both languages read it: one that is too large is infinite to both."""
    if math.isnan(value):
        return "(1e999-1e999)"
    text = repr(value).replace("inf", "1e999")
    return f"({text})" if text.startswith("-") else text
