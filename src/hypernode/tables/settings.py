"""Tables of what a section of the configuration defines."""

from hypernode.tables.columns import Column
from hypernode.tables.limits import MOST_COLUMNS
from hypernode.tables.table import Table, make_frame

LIKE, DIFFERENCES = "like", "but"
NOTE = "Each entry is described by how it differs from the earlier one that is nearest to it."
#: Setting -> its unit; moduli of sheets with a thickness are in MPa.
UNITS = {key: "Pa or MPa" for key in ("mu", "K", "C10", "C01", "C20", "C30", "k1", "k1w")} | {"fibre_angle": "degree"}


def settings_table(entries: dict[str, dict]) -> Table:
    """One row an entry of a section, one column a setting.

    Where there are too many settings to read, an entry shows how it differs from the earlier one that is nearest to it.

    Args:
        entries: name -> settings, which may be nested.
    """
    flat = {name: _flatten(entry) for name, entry in entries.items()}
    keys = dict.fromkeys(key for entry in flat.values() for key in entry)
    head = {key: f"{key} [{UNITS[key]}]" if key in UNITS else key for key in keys}
    columns = {head[key]: Column(key, "text") for key in keys}
    rows = [{"name": name} | {head[key]: value for key, value in entry.items()} for name, entry in flat.items()]
    if 1 + len(columns) <= MOST_COLUMNS:
        return Table(make_frame(rows, ["name"], columns), columns, list(columns))
    for index, (row, entry) in enumerate(zip(rows, flat.values(), strict=True)):
        earlier = list(flat)[:index]
        like = min(earlier, key=lambda name, entry=entry: len(_changed(entry, flat[name])), default=None)
        row |= {LIKE: like, DIFFERENCES: _difference(entry, flat[like] if like else {})}
    columns |= {LIKE: Column("", "text"), DIFFERENCES: Column("", "text")}
    return Table(make_frame(rows, ["name"], columns), columns, [LIKE, DIFFERENCES], notes=[NOTE])


def _changed(entry: dict[str, str], other: dict[str, str]) -> list[str]:
    return [key for key in {**entry, **other} if entry.get(key) != other.get(key)]


def _difference(entry: dict[str, str], other: dict[str, str]) -> str:
    """What an entry has that another one has not, and the parts that it lacks."""
    own = [f"{key} = {entry[key] or 'none'}" for key in _changed(entry, other) if key in entry]
    parts = {key.split(".")[0] for key in entry}
    lacking = dict.fromkeys(
        part if (part := key.split(".")[0]) not in parts else key for key in other if key not in entry
    )
    return "; ".join([*own, *(f"without {part}" for part in lacking)])


def _flatten(entry: dict, prefix: str = "") -> dict[str, str]:
    flat = {}
    for key, value in entry.items():
        if isinstance(value, dict):
            flat |= _flatten(value, f"{prefix}{key}.")
        elif value is not None:
            flat[prefix + key] = ", ".join(map(str, value)) if isinstance(value, list) else str(value)
    return flat
