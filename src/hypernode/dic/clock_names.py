"""Names of files that are the times of their pictures."""

import re
from collections.abc import Sequence

#: Hours, minutes and seconds, with a date in front or without, in one run of digits or in several.
_CLOCK = re.compile(
    r"(?P<date>(?:19|20)\d{2}[-_.]?(?:0[1-9]|1[0-2])[-_.]?(?:0[1-9]|[12]\d|3[01])[-_ T.]{0,3})?"
    r"(?<!\d)(?P<h>[01]\d|2[0-3])(?P<sign>[-_.:h]?)(?P<m>[0-5]\d)(?P<other>[-_.:m]?)(?P<s>[0-5]\d)(?P<part>(?:[.,_-]|(?=\d))\d{1,6})?s?(?!\d)"
)
_GLUED = re.compile(
    r"(?<!\d)(?P<date>(?:19|20)\d{2}(?:0[1-9]|1[0-2])(?:0[1-9]|[12]\d|3[01]))(?P<h>[01]\d|2[0-3])(?P<sign>)(?P<m>[0-5]\d)(?P<other>)"
    r"(?P<s>[0-5]\d)(?P<part>\d{1,6})?(?!\d)"
)
_DAY = 86400.0
#: Share of the numbers between the first and the last one below which they are no counter.
_SPARSE = 0.75


def times_of(names: Sequence[str]) -> list[float] | None:
    """Seconds since midnight of the first day that each name says; None where names are no clock times.

    A run of six digits, or of two and four, is a clock time in two cases. A date stands before it, or as a counter it
    would leave gaps at the ends of minutes.
    """
    for pattern in (_GLUED, _CLOCK):
        found = [_last(pattern, name) for name in names]
        if all(found) and len({pattern.sub("#", name) for name in names}) == 1:
            times = [_seconds(each) for each in found]
            certain = found[0]["date"] or (found[0]["sign"] and found[0]["other"]) or _skips_like_a_clock(names, times)
            if len(set(times)) == len(times) > 1 and certain:
                return _over_midnight(times)
    return None


def _last(pattern: re.Pattern, name: str) -> re.Match | None:
    return max(pattern.finditer(name), key=lambda match: match.start(), default=None)


def _seconds(match: re.Match) -> float:
    part = (match["part"] or "").strip(".,_-")
    return 3600.0 * int(match["h"]) + 60.0 * int(match["m"]) + int(match["s"]) + (float(f"0.{part}") if part else 0.0)


def _skips_like_a_clock(names: Sequence[str], times: Sequence[float]) -> bool:
    """Whether numbers are dense as seconds, and full of holes as a counter."""
    numbers = sorted(int(re.sub(r"\D", "", _last(_CLOCK, name)[0])) for name in names)
    seconds = sorted(times)
    dense = (len(seconds) - 1) / (seconds[-1] - seconds[0]) if seconds[-1] > seconds[0] else 0.0
    return dense > _SPARSE and (len(numbers) - 1) / (numbers[-1] - numbers[0]) < _SPARSE


def _over_midnight(times: list[float]) -> list[float]:
    """Times of a test that is shorter than half a day."""
    if max(times) - min(times) <= _DAY / 2:
        return times
    return [time + _DAY if time < _DAY / 2 else time for time in times]
