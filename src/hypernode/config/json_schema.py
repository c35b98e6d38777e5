"""The JSON Schema of a configuration file, from which editors complete keys and show what they mean."""

import ast
import copy
import inspect
import json
import sys
from functools import cache

from pydantic.json_schema import GenerateJsonSchema

from hypernode.config.model import Config
from hypernode.config.presets import presets
from hypernode.config.section import NAME, Section
from hypernode.mechanics.parameters import PARAMETERS

DIALECT = "https://json-schema.org/draft/2020-12/schema"
_DEFINITION = "#/$defs/"
#: Prefix of the definitions of what a method may change of the one that it extends.
_CHANGED = "Changed"
_PARAMETERS = {
    "mu": "Shear modulus [Pa].",
    "K": "Stiffness against a change of volume [Pa].",
    "C10": "Coefficient of I1 - 3 [Pa].",
    "C01": "Coefficient of I2 - 3 [Pa].",
    "C20": "Coefficient of (I1 - 3)^2 [Pa].",
    "C30": "Coefficient of (I1 - 3)^3 [Pa].",
    "k1": "Stiffness of the fibres [Pa].",
    "k1w": "Stiffness of the second, perpendicular family of fibres [Pa].",
    "k2": "How fast the fibres stiffen [-].",
    "kappa": "Dispersion of the fibres: 0 aligned, 1/3 isotropic [-].",
    "alpha": "Exponent of the stretches, not zero [-].",
    "Jm": "I1 - 3 at which the sheet can be stretched no further [-].",
    "b": "How fast the sheet stiffens [-].",
    "c": "Stiffness of the exponential [Pa].",
    "a_v": "How fast it grows with the strain along the fibres [-].",
    "a_w": "How fast it grows with the strain across them [-].",
    "a_vw": "How fast it grows with the product of both [-].",
    "a_s": "How fast it grows with their shear [-].",
    "fibre_angle": "Direction of the fibres, anticlockwise from x [degrees].",
}


class _Generator(GenerateJsonSchema):
    """Pydantic's generator without the titles, which repeat the keys."""

    def field_title_should_be_set(self, schema) -> bool:
        return False


def text() -> str:
    """The file ``config/schema.json``."""
    return json.dumps(schema(), indent=1, ensure_ascii=False) + "\n"


def schema() -> dict:
    """The JSON Schema of a configuration file, as a mapping."""
    whole = Config.model_json_schema(schema_generator=_Generator)
    definitions = whole["$defs"]
    for section in _sections(Section):
        place = whole if section is Config else definitions.get(section.__name__)
        if place is not None:
            _describe(place, section)
    definitions["Material"] = _material(definitions["Material"])
    _add_extends(whole)
    for section in whole["properties"].values():
        if section.get("type") == "object":
            section["propertyNames"] = {"pattern": NAME.pattern}
    return {"$schema": DIALECT, "title": "hypernode configuration", **whole}


def _sections(section: type[Section]) -> list[type[Section]]:
    return [section, *(each for sub in section.__subclasses__() for each in _sections(sub))]


def _describe(place: dict, section: type[Section]) -> None:
    """Add the sentences that stand below the fields of a section, and the section's own."""
    place.pop("title", None)
    place["description"] = inspect.getdoc(section)
    bases = [each for each in section.__mro__ if issubclass(each, Section)]
    documented = [_documented(sys.modules[each.__module__]).get(each.__name__, {}) for each in bases]
    for key, field in place["properties"].items():
        found = [sentences[key] for sentences in documented if key in sentences]
        if found:
            field["description"] = found[0]
        elif "const" in field:
            # The word that tells one kind of entry from another means what the section means.
            field["description"] = place["description"].splitlines()[0]


@cache
def _documented(module) -> dict[str, dict[str, str]]:
    """Class -> field -> the text below it. Read here, since in pydantic every job would do it at its start."""
    return {
        node.name: {
            field.target.id: inspect.cleandoc(below.value.value).replace("\n", " ")
            for field, below in zip(node.body, node.body[1:], strict=False)
            if isinstance(field, ast.AnnAssign)
            and isinstance(below, ast.Expr)
            and isinstance(below.value, ast.Constant)
        }
        for node in ast.parse(inspect.getsource(module)).body
        if isinstance(node, ast.ClassDef)
    }


def _material(generated: dict) -> dict:
    """A material has the parameters of its model and no others."""
    models = [
        {
            "properties": {
                "model": {"const": model, "description": generated["properties"]["model"]["description"]},
                **{
                    name: {
                        "type": "number",
                        "minimum": lower,
                        "maximum": upper,
                        "description": _PARAMETERS[name],
                    }
                    for name, (lower, upper) in parameters.items()
                },
            },
            "required": ["model", *parameters],
            "additionalProperties": False,
        }
        for model, parameters in PARAMETERS.items()
    ]
    return {"type": "object", "description": generated["description"], "oneOf": models}


def _add_extends(whole: dict) -> None:
    """Let a method extend another: then no key is required of it, and any may be null, which removes it."""
    definitions = whole["$defs"]
    waiting, changed = ["Method"], {}
    while waiting:
        name = waiting.pop()
        if f"{_CHANGED}{name}" in changed:
            continue
        section = copy.deepcopy(definitions[name])
        section.pop("required", None)
        for key, field in section["properties"].items():
            field.pop("default", None)
            options = [option for option in field.pop("anyOf", []) if option != {"type": "null"}]
            if not options:
                kept = {"description": field.pop("description")} if "description" in field else {}
                options, field = [field], kept
            for option in options:
                if "$ref" in option:
                    waiting.append(option["$ref"].removeprefix(_DEFINITION))
                    option["$ref"] = f"{_DEFINITION}{_CHANGED}{waiting[-1]}"
            section["properties"][key] = {**field, "anyOf": [*options, {"type": "null"}]}
        changed[f"{_CHANGED}{name}"] = section
    changed[f"{_CHANGED}Method"]["properties"] = {
        "extends": {
            "type": "string",
            "description": "Preset, or method of this configuration, of which this one says what differs.",
            "examples": list(presets()),
        },
        **changed[f"{_CHANGED}Method"]["properties"],
    }
    definitions |= changed
    whole["properties"]["methods"]["additionalProperties"] = {
        "if": {"required": ["extends"]},
        "then": {"$ref": f"{_DEFINITION}{_CHANGED}Method"},
        "else": {"$ref": f"{_DEFINITION}Method"},
    }
