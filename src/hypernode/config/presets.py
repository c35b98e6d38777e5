"""Methods that every configuration may name, and methods that say only what they change of another."""

import difflib
from collections.abc import Callable
from functools import cache
from pathlib import Path

from hypernode.config.errors import ConfigError
from hypernode.config.merging import deep_merge, without_nulls
from hypernode.config.sources import Sources, read_yaml

FILE = Path(__file__).with_name("presets.yaml")


@cache
def presets() -> dict[str, dict]:
    """Name -> settings of each method that is shipped."""
    source = Sources((read_yaml(FILE),))
    return resolved_methods(source.merged(), {}, source.where)


def resolved_methods(own: dict, shipped: dict[str, dict], where: Callable[..., str]) -> dict:
    """The methods of a configuration, each laid over the one that it ``extends``.

    Args:
        own: name -> what the configuration says of the method.
        shipped: name -> settings of the methods that it may extend beside its own.
        where: 'file:line' of a key path.

    Returns:
        The methods without ``extends`` and without the keys that are set to null in one that extends another.

    Raises:
        ConfigError: ``extends`` names no method or leads in a circle, or a shipped method is defined anew.
    """
    return {name: _resolved(name, own, shipped, where) for name in own}


def lineage(name: str, own: dict) -> list[str]:
    """A method of a configuration and those of the same configuration that it extends, the nearest first."""
    names = [name]
    while (base := _entry(own, names[-1]).get("extends")) in own and base not in names:
        names.append(base)
    return names


def _entry(own: dict, name: str) -> dict:
    return own[name] if isinstance(own[name], dict) else {}


def _resolved(name: str, own: dict, shipped: dict, where, above: tuple[str, ...] = ()):
    entry = own[name]
    if not isinstance(entry, dict):
        return entry
    if "extends" not in entry:
        if name in shipped:
            raise ConfigError(
                f"{where('methods', name)}: methods.{name}: a preset has this name: say 'extends: {name}' and what "
                "differs, or choose another name"
            )
        return entry
    base = entry["extends"]
    at = f"{where('methods', name, 'extends')}: methods.{name}.extends = {base!r}"
    if base in above or (base == name and base not in shipped):
        raise ConfigError(f"{at}: goes in a circle: {' -> '.join((*above, name, str(base)))}")
    if isinstance(base, str) and base in own and base != name:
        settings = _resolved(base, own, shipped, where, (*above, name))
        if not isinstance(settings, dict):
            return entry
    elif isinstance(base, str) and base in shipped:
        settings = shipped[base]
    else:
        names = [each for each in (*own, *shipped) if each != name]
        near = difflib.get_close_matches(str(base), names, 1, cutoff=0.5)
        hint = f"; did you mean '{near[0]}'?" if near else ""
        raise ConfigError(f"{at}: no such method or preset{hint}\n    allowed: {', '.join(names)}")
    change = {key: value for key, value in entry.items() if key != "extends"}
    return without_nulls(deep_merge(settings, change))
