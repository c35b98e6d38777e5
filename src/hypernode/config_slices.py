"""The part of a configuration that one rule uses, so that an edit of another part reruns nothing."""

import json

from pydantic import TypeAdapter

from hypernode.config import Case, Config, Method


def slice_for(config: Config, name: str, sections=(), keys=None) -> dict:
    """The part of the configuration that one rule uses, as plain data for its ``params``.

    Args:
        name: case.
        sections: sections whose entries used by the case are included.
        keys: keys of the case that matter to the rule; all but ``methods`` when left out.

    Returns:
        A mapping that :func:`from_slice` turns back into a configuration of that one case.
    """
    case = config.cases[name].model_dump(mode="json", exclude_defaults=True)
    kept = {k: v for k, v in case.items() if k != "methods" and (keys is None or k in keys)}
    used = {
        "geometries": [case.get("geometry")],
        "materials": [case.get("matrix"), case.get("inclusion")],
        "loads": case.get("loads", []),
        "noise": [case.get("noise")],
        "specimens": [case.get("specimen")],
    }
    result = {"cases": {name: kept}}
    for section in sections:
        entries = getattr(config, section)
        result[section] = {
            key: entries[key].model_dump(mode="json") for key in dict.fromkeys(used[section]) if key in entries
        }
    return in_fixed_order(result)


def in_fixed_order(settings):
    """Plain data with sorted keys, so that reordering a configuration reruns nothing."""
    return json.loads(json.dumps(settings, sort_keys=True))


def from_slice(settings: dict) -> Config:
    """The configuration of one case from :func:`slice_for`; checked once already, so not again."""
    settings = dict(settings)
    cases = {name: Case.model_construct(**{**_case_defaults(), **case}) for name, case in settings.pop("cases").items()}
    return Config.model_validate(settings).model_copy(update={"cases": cases})


def _case_defaults() -> dict:
    return {name: field.get_default(call_default_factory=True) for name, field in Case.model_fields.items()}


def partial_method(settings: dict) -> Method:
    """A method that holds only the given parts, checked: a stage sees nothing that it does not use."""
    parts = {key: TypeAdapter(Method.model_fields[key].annotation).validate_python(v) for key, v in settings.items()}
    return Method.model_construct(set(parts), **{**dict.fromkeys(Method.model_fields), **parts})
