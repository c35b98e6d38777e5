"""The part of a configuration that one rule uses, so that an edit of another part reruns nothing."""

import json

from pydantic import TypeAdapter

from hypernode.config.cases import Case
from hypernode.config.methods import Method
from hypernode.config.model import Config


def slice_for(config: Config, name: str, sections, keys) -> dict:
    """The part of the configuration that one rule uses, as plain data for its ``params``.

    Args:
        name: case.
        sections: sections whose entries used by the case are included.
        keys: keys of the case that matter to the rule.

    Returns:
        A mapping that :func:`from_slice` turns back into a configuration of that one case.
    """
    case = config.cases[name].model_dump(mode="json", exclude_defaults=True)
    kept = {k: v for k, v in case.items() if k in keys}
    used = {
        "geometries": case_geometries(config.cases[name]),
        "materials": case_materials(config.cases[name]),
        "loads": [load for key in ("loads", "unseen_loads") if key in keys for load in case.get(key, [])],
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


def pictures_for(config: Config, name: str, stage: str) -> dict:
    """What one stage of a photographed case uses: ``speckle``, ``photograph`` or ``correlate``."""
    case = config.cases[name]
    camera, size = case.camera, case.size
    if stage == "correlate":
        return in_fixed_order(camera.correlated.model_dump(mode="json"))
    pixel = {"mm_per_pixel": camera.pixel_size(size)}
    if stage == "speckle":
        sprayed = camera.pictures.speckle.model_dump(mode="json")
        return in_fixed_order({**pixel, "size": size, "thickness": case.thickness, "speckle": sprayed})
    return in_fixed_order({**pixel, "pictures": camera.pictures.model_dump(mode="json", exclude={"speckle", "pixels"})})


def case_geometries(case: Case) -> list[str]:
    """Names of the geometries that a synthetic case uses."""
    return [key for key in (case.geometry, case.hole, *(phase.geometry for phase in case.further_phases)) if key]


def case_materials(case: Case) -> list[str]:
    """Names of the materials that a synthetic case uses."""
    return [key for key in (case.matrix, case.inclusion, *(phase.material for phase in case.further_phases)) if key]


def in_fixed_order(settings):
    """Plain data with sorted keys, so that reordering a configuration reruns nothing."""
    return json.loads(json.dumps(settings, sort_keys=True))


def from_slice(settings: dict) -> Config:
    """The configuration of one case from :func:`slice_for`; checked once already, so not again."""
    settings = dict(settings)
    cases = {name: _partial_case(case) for name, case in settings.pop("cases").items()}
    return Config.model_validate(settings).model_copy(update={"cases": cases})


def _partial_case(given: dict) -> Case:
    defaults = {name: field.get_default(call_default_factory=True) for name, field in Case.model_fields.items()}
    return Case.model_construct(**{**defaults, **_validated(Case, given)})


def _validated(section, given: dict) -> dict:
    return {key: TypeAdapter(section.model_fields[key].annotation).validate_python(v) for key, v in given.items()}


def partial_method(settings: dict) -> Method:
    """A method that holds only the given parts, checked: a stage sees nothing that it does not use."""
    parts = _validated(Method, settings)
    return Method.model_construct(set(parts), **{**dict.fromkeys(Method.model_fields), **parts})
