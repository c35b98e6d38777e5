"""Whether the results of a folder were computed alike, and as they would be computed now."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from hypernode.storage.environment import versions
from hypernode.storage.findings import Finding


def _most(values: Iterable[str]) -> str:
    """The value that most have; of equally many the last in the alphabet, so that the answer is always the same."""
    counts = Counter(values)
    return max(counts, key=lambda value: (counts[value], value))


def foreign_versions(records: Mapping[Path, dict]) -> list[Finding]:
    """Files made with a version of a package that others of the folder, or the installation, do not have."""
    installed, found = versions(), []
    for package in sorted({name for record in records.values() for name in record["versions"]}):
        used = {path: r["versions"][package] for path, r in records.items() if package in r["versions"]}
        usual, now = _most(used.values()), installed.get(package, "none")
        for path, version in used.items():
            others = f", most others with {usual}" if version != usual else ""
            if version != now or others:
                message = f"made with {package} {version}{others}, installed is {now}"
                found.append(Finding(str(path), f"{message}; delete it and run again, or install that version"))
    return found


#: Takes a rule, and the flags that a job of it had, to what such a job would set now; None where that is not known.
Now = Callable[[str, Mapping[str, str]], Mapping[str, str] | None]


def foreign_flags(records: Mapping[Path, dict], now: Now) -> list[Finding]:
    """Files whose job had other flags of the compiler, or another precision, than other jobs of its rule.

    Args:
        records: the records of a folder.
        now: what a job would set now; one of which that is not known is not compared with now.
    """
    found = []
    for rule in sorted({record["rule"] for record in records.values() if record.get("compiler")}):
        jobs = {path: r["compiler"] for path, r in records.items() if r["rule"] == rule and r.get("compiler")}
        wanted_now = {path: now(rule, settings) for path, settings in jobs.items()}
        for variable in sorted(set().union(*(wanted or () for wanted in wanted_now.values()), *jobs.values())):
            values = {path: settings.get(variable, "") for path, settings in jobs.items()}
            usual = _most(values.values())
            for path, value in values.items():
                wanted = None if wanted_now[path] is None else wanted_now[path].get(variable, "")
                differs = [f"most other jobs of the rule {rule} with '{usual}'"] if value != usual else []
                differs += [f"its rule would now set '{wanted}'"] if wanted not in (None, value) else []
                if differs:
                    message = f"made with {variable}='{value}', {', '.join(differs)}; delete it and run again"
                    found.append(Finding(str(path), message))
    return found


def foreign_machines(records: Mapping[Path, dict]) -> list[Finding]:
    """Notices of files computed by another kind of processor, or another Python, than most others."""
    machines = {"processor": {}, "Python": {}}
    for path, record in records.items():
        if record.get("processor"):
            machines["processor"][path] = " ".join(filter(None, record["processor"].values()))
        if record.get("python"):
            machines["Python"][path] = record["python"]
    found = []
    for kind, used in machines.items():
        usual = _most(used.values()) if used else ""
        for path, machine in used.items():
            if machine != usual:
                message = f"made with the {kind} {machine}, most others with {usual}: last digits may differ"
                found.append(Finding(str(path), message, notice=True))
    return found
