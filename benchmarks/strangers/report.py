"""The table and the figure of a study."""

from collections import Counter

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter

from benchmarks.strangers.write import MODES
from hypernode.figures.style import INCLUSION, MATRIX, NEUTRAL, RC, SECOND
from hypernode.tables.columns import Column
from hypernode.tables.table import Table, make_frame
from hypernode.verdict import Level

LABELS = ["seed", "shape", "law", "laws", "load"]
ERRORS = ("tested", "everywhere", *MODES)
COLUMNS = {
    **{name: Column(name, "percent") for name in ERRORS},
    "level": Column("level", "share"),
    **{f"field, {name}": Column(f"field {name}", "percent") for name in ERRORS},
    "field, level": Column("field level", "share"),
    **{f"within two spreads, {mode}": Column(f"within two spreads, {mode}", "share") for mode in MODES},
    "noise": Column("noise", "number", unit="pixel"),
    "window": Column("window", "number", unit="steps"),
    "seen": Column("seen", "share"),
    "points": Column("points", "count"),
    "largest strain": Column("top", "share"),
    "verdict": Column("verdict", "text"),
    "because": Column("because", "text"),
    "processor": Column("cpu_s", "number", unit="s"),
    "clock": Column("clock_s", "number", unit="s"),
    "steps": Column("steps_s", "text"),
    "error": Column("error", "text"),
}
SHOWN = ["tested", "everywhere", "field, tested", "field, everywhere", *(f"field, {mode}" for mode in MODES)]
SHOWN += [f"within two spreads, {mode}" for mode in MODES]
SHOWN += ["level", "noise", "window", "seen", "verdict", "because", "processor", "steps", "error"]
#: Level -> colour and marker, told apart with any colour vision and in grey.
LOOK = {Level.PASSED: (SECOND, "o"), Level.WARNED: ("#E69F00", "^"), Level.FAILED: (INCLUSION, "s")}
#: Errors up to which a sheet is right, and from which it is wrong.
RIGHT, WRONG = 0.03, 0.05


def scored(rows: list[dict]) -> list[dict]:
    """Rows that have an error of the stress."""
    return [row for row in rows if row.get("tested") is not None]


def table_of(rows: list[dict]) -> Table:
    """A row a sheet, with what they say together in notes."""
    named = []
    for row in rows:
        steps = sorted(row.get("steps", {}).items(), key=lambda item: -item[1])
        row = row | {"steps_s": ", ".join(f"{name} {seconds:.0f}" for name, seconds in steps if seconds >= 1.0)}
        named.append({label: row.get(label, "-") for label in LABELS} | {n: row.get(c.key) for n, c in COLUMNS.items()})
    return Table(make_frame(named, LABELS, COLUMNS), COLUMNS, SHOWN, notes=notes(rows))


def notes(rows: list[dict]) -> list[str]:
    """Sentences that sum a study up."""
    good = scored(rows)
    found = [f"{len(rows)} sheets, {len(good)} scored."]
    if not good:
        return found
    for what, prefix in (("material.nc", ""), ("field", "field ")):
        for name in ("tested", "everywhere"):
            errors = [row[prefix + name] for row in good if prefix + name in row]
            found.append(f"{what}, {name}: {_spoken(errors)}")
    ratios = [row["tested"] / row["field tested"] for row in good if "field tested" in row]
    found.append(f"material.nc over its field: median {np.median(ratios):.2f}, largest {max(ratios):.2f}.")
    for mode in MODES:
        shares = [row[key] for row in good if (key := f"within two spreads, {mode}") in row]
        if shares:
            found.append(f"truth within two spreads, {mode}: mean {np.mean(shares):.3f}.")
    for what, chosen in (
        (f"right (up to {RIGHT})", [row for row in good if row["tested"] <= RIGHT]),
        (f"wrong (above {WRONG})", [row for row in good if row["tested"] > WRONG]),
    ):
        counted = Counter(row["verdict"] for row in chosen)
        found.append(f"{what}: {', '.join(f'{count} {level}' for level, count in sorted(counted.items())) or 'none'}.")
    seconds = [row["cpu_s"] for row in good]
    found.append(f"processor: median {np.median(seconds):.0f} s, largest {max(seconds):.0f} s a sheet.")
    versions = {row.get("code") for row in good}
    if len(versions) > 1:
        found.append(f"These sheets were identified by {len(versions)} versions of the code: delete their folders.")
    return found


def _spoken(errors: list[float]) -> str:
    worst = f"nine of ten within {np.quantile(errors, 0.9):.4f}, largest {max(errors):.4f}"
    return f"median {np.median(errors):.4f}, {worst}, {np.mean(np.array(errors) <= RIGHT):.2f} of them right."


def draw(rows: list[dict]):
    """Errors by sheet, error by verdict, and time."""
    good = sorted(scored(rows), key=lambda row: row["tested"])
    places = np.arange(len(good))
    with plt.rc_context(RC):
        figure, (by_sheet, by_verdict, by_time) = plt.subplots(
            1, 3, figsize=(7.2, 2.8), width_ratios=(2.2, 1.0, 1.2), layout="constrained"
        )
        for level, (colour, marker) in LOOK.items():
            own = [k for k, row in enumerate(good) if row["verdict"] == level]
            tested, everywhere = ([good[k][name] for k in own] for name in ("tested", "everywhere"))
            by_sheet.plot(places[own], tested, marker, color=colour, ms=4, label=f"{level}, off interfaces")
            by_sheet.plot(places[own], everywhere, marker, color=colour, ms=4, mfc="none", label=f"{level}, everywhere")
            offsets = np.linspace(-0.2, 0.2, len(own)) if len(own) > 1 else np.zeros(len(own))
            by_verdict.plot(level.rank + offsets, tested, marker, color=colour, ms=4)
            by_time.plot(tested, [good[k]["cpu_s"] for k in own], marker, color=colour, ms=4)
        by_sheet.set_xticks(places, [row["seed"] for row in good], rotation=90)
        by_sheet.set_xlabel("seed, by error")
        by_sheet.set_ylabel("error of the stress [-]")
        by_verdict.set_xticks([level.rank for level in LOOK], list(LOOK))
        by_verdict.set_xlabel("verdict")
        by_verdict.set_ylabel("error off interfaces [-]")
        for axes in (by_sheet, by_verdict):
            axes.set_yscale("log")
            for bound, style in ((RIGHT, ":"), (WRONG, "--")):
                axes.axhline(bound, color=NEUTRAL, lw=0.6, ls=style)
        by_time.set(xscale="log", xlabel="error off interfaces [-]", ylabel="processor [s]")
        by_verdict.set_xlim(Level.PASSED.rank - 0.5, Level.FAILED.rank + 0.5)
        for axis in (by_sheet.yaxis, by_verdict.yaxis, by_time.xaxis):
            # Less than a decade has few powers of ten.
            axis.set_major_locator(FixedLocator([0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0]))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.3g}"))
            axis.set_minor_formatter(NullFormatter())
        by_time.axhline(np.median([row["cpu_s"] for row in good]) if good else 0.0, color=MATRIX, lw=0.6)
        by_time.set_ylim(bottom=0.0)
        figure.legend(*by_sheet.get_legend_handles_labels(), loc="outside upper center", ncols=3)
        return figure
