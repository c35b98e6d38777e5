"""Mappings laid over one another: later files over earlier ones, a method over what it extends."""


def deep_merge(base, change):
    """``change`` laid over ``base``: mappings key by key, everything else replaced; neither is altered."""
    if not (isinstance(base, dict) and isinstance(change, dict)):
        return change
    merged = dict(base)
    for key, value in change.items():
        merged[key] = deep_merge(base[key], value) if key in base else value
    return merged


def without_nulls(value):
    """A mapping without the keys, at any depth, that are set to null."""
    if not isinstance(value, dict):
        return value
    return {key: without_nulls(inner) for key, inner in value.items() if inner is not None}
