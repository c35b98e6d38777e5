"""The schema of the configuration, and errors that say where, what and how to mend it.

A configuration names geometries, materials, loads, noise levels, methods and specimens; ``cases``
combine them and ``grid`` blocks expand products of them into more cases. Everything is checked
before any job starts.
"""

import difflib
import itertools
import json
import re
from pathlib import Path
from typing import Annotated, Literal, Union, get_args

import yaml
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError, model_validator

from hypernode.mechanics.loads import CONSTRAINED
from hypernode.mechanics.material_names import PARAMETERS
from hypernode.networks.terms import TERMS

NAME = re.compile(r"^[A-Za-z0-9][A-Za-z0-9_.-]*$")
LoadKind = Literal["equibiaxial", "biaxial", "uniaxial_x", "uniaxial_y", "clamped_x", "clamped_y", "shear"]
assert set(get_args(LoadKind)) == set(CONSTRAINED), "the schema lists every load kind"

Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]
Fraction = Annotated[float, Field(ge=0, le=1)]
Count = Annotated[int, Field(ge=1)]
Point = tuple[float, float]


class ConfigError(ValueError):
    """The configuration is wrong; the message is complete and needs no traceback."""


class Section(BaseModel):
    """A mapping with a fixed set of keys."""

    model_config = ConfigDict(extra="forbid", strict=False, frozen=True)


class Glyph(Section):
    """A letter or word drawn from DejaVu Sans."""

    shape: Literal["glyph"]
    text: str = Field(min_length=1)
    height: Positive = 0.6
    centre: Point = (0.5, 0.5)
    bold: bool = True


class Ellipse(Section):
    """An ellipse; a disc has equal semi-axes."""

    shape: Literal["ellipse"]
    semi_axes: tuple[Positive, Positive]
    centre: Point = (0.5, 0.5)
    angle: float = 0.0


class Disc(Section):
    """A disc."""

    shape: Literal["disc"]
    radius: Positive
    centre: Point = (0.5, 0.5)


class Ring(Section):
    """The points between two concentric circles."""

    shape: Literal["ring"]
    inner_radius: NonNegative
    outer_radius: Positive
    centre: Point = (0.5, 0.5)

    @model_validator(mode="after")
    def _ordered(self):
        if self.inner_radius >= self.outer_radius:
            raise ValueError("inner_radius must be smaller than outer_radius")
        return self


class Image(Section):
    """The bright pixels of an image, stretched over the sheet, first row at the top."""

    shape: Literal["image"]
    path: str
    threshold: Fraction = 0.5
    invert: bool = False


class Gradient(Section):
    """A smooth transition across the sheet with no jump."""

    shape: Literal["gradient"]
    direction: float = 0.0
    profile: Literal["linear", "sine"] = "linear"


class Uniform(Section):
    """One phase everywhere."""

    shape: Literal["uniform"]


Geometry = Annotated[Union[Glyph, Ellipse, Disc, Ring, Image, Gradient, Uniform], Field(discriminator="shape")]


class Material(Section):
    """A closed-form material: ``model`` and its parameters; fibre_angle in degrees."""

    model_config = ConfigDict(extra="allow", frozen=True)
    model: Literal[tuple(PARAMETERS)]

    @model_validator(mode="before")
    @classmethod
    def _parameters(cls, values):
        if not isinstance(values, dict) or values.get("model") not in PARAMETERS:
            return values
        wanted = PARAMETERS[values["model"]]
        for key, value in values.items():
            if key == "model":
                continue
            if key not in wanted:
                near = difflib.get_close_matches(key, wanted, 1)
                hint = f"; did you mean '{near[0]}'?" if near else ""
                raise ValueError(f"'{key}' is not a parameter of {values['model']} ({', '.join(wanted)}){hint}")
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                raise ValueError(f"'{key}' must be a number, not {value!r}")
            lower, upper = wanted[key]
            if not lower <= value <= upper:
                raise ValueError(f"'{key}' = {value!r} is outside {lower:g} ... {upper:g}")
        missing = [key for key in wanted if key not in values]
        if missing:
            raise ValueError(f"{values['model']} also needs {', '.join(missing)}")
        return values

    @property
    def parameters(self) -> dict[str, float]:
        """Parameter values by name, as written (fibre_angle in degrees)."""
        return dict(self.model_extra)


class Load(Section):
    """A load case: its kind and the edge stretch of every step."""

    kind: LoadKind
    stretches: list[Union[Positive, tuple[Positive, Positive]]] = Field(min_length=1)

    @model_validator(mode="after")
    def _pairs(self):
        if any(isinstance(s, tuple) != (self.kind == "biaxial") for s in self.stretches):
            wanted = "pairs [x, y]" if self.kind == "biaxial" else "single numbers"
            raise ValueError(f"stretches of a {self.kind} load are {wanted}")
        return self


class Noise(Section):
    """Measurement error of the displacement, in the length unit of the test."""

    sigma: NonNegative = 0.0
    repeats: Count = 1
    seed: int = Field(default=0, ge=0)


class Frequencies(Section):
    """Sizes of a network on random Fourier features."""

    features: Count
    frequency_scale: Positive
    widths: list[Count] = Field(min_length=1)


class Optimiser(Section):
    """Iterations, first learning rate, and the number of points seen in each iteration."""

    iterations: Annotated[int, Field(ge=0)]
    learning_rate: Positive = 0.01
    algorithm: Literal["adam", "muon"] = "muon"
    points: Count | None = None


class Interpolant(Frequencies, Optimiser):
    """The network (X, t) -> F."""


class Node(Section):
    """The neural ODEs of a material point."""

    terms: list[Literal[tuple(TERMS)]] = Field(min_length=1)
    hidden: list[Count] = Field(min_length=1)
    rk4_steps: Count = 2

    @model_validator(mode="after")
    def _once(self):
        if len(set(self.terms)) != len(self.terms):
            raise ValueError("a term is listed twice")
        if "I1" not in self.terms and "I2" not in self.terms:
            raise ValueError(
                "terms need I1 or I2: a material without an isotropic part has no stiffness across its fibres"
            )
        return self


class Training(Optimiser):
    """The last stage: equilibrium and edge resultants together.

    ``equilibrium`` names how the residual is formed and measured: ``strong`` (finite-difference
    divergence on the measured grid) or ``autodiff`` (exact derivative of the interpolated fields),
    both as mean squares at points; or ``equilibrated`` (distance from the nearest equilibrated stress).
    ``uniformity_weight`` keeps the target of the pre-training as a weak prior, which decides among the
    stress fields that one noisy test cannot tell apart.
    """

    equilibrium: Literal["strong", "autodiff", "equilibrated"] = "equilibrated"
    equilibrium_weight: NonNegative = 1.0
    force_weight: NonNegative = 1.0
    uniformity_weight: NonNegative = 0.0


class Method(Section):
    """Everything that turns a measurement into a material."""

    gradient: Literal["element", "finite_difference"] = "element"
    interpolant: Interpolant
    node: Node
    hypernetwork: Frequencies
    homogenised: Optimiser
    initialisation: Optimiser
    pretraining: Optimiser
    training: Training
    prior_weight: NonNegative = 1e-3
    seed: int = Field(default=0, ge=0)


class Specimen(Section):
    """A real test: where its files are and how to read them.

    Lengths in mm, times in s, forces in N. Either ``frames`` (numbers) or ``stretches`` (target
    mean stretches along the tensile axis) selects the load steps.
    """

    folder: str
    format: Literal["davis"] = "davis"
    force_file: str = "force_disp.csv"
    published_at: str = ""
    load: Literal["clamped_x", "clamped_y"] = "clamped_y"
    width: Positive
    height: Positive
    thickness: Positive
    pixel_size: Positive
    frame_rate: Positive
    first_frame_time: float = 0.0
    edge_ring: Annotated[int, Field(ge=0)] = 1
    frames: list[Count] | None = None
    stretches: list[Annotated[float, Field(gt=1)]] | None = None
    noise_pixels: Positive = 0.3
    shape_image: str | None = None
    shape_flipped: bool = False
    source_title: str = ""

    @model_validator(mode="after")
    def _selection(self):
        if (self.frames is None) == (self.stretches is None):
            raise ValueError("give either frames or stretches")
        return self


class Case(Section):
    """One sheet and its tests: a synthetic one (geometry, materials, loads) or a specimen."""

    geometry: str | None = None
    inclusion: str | None = None
    matrix: str | None = None
    loads: list[str] = []
    noise: str | None = None
    specimen: str | None = None
    cells: tuple[Count, Count] = (50, 50)
    size: tuple[Positive, Positive] = (1.0, 1.0)
    methods: list[str] = []
    judged_stretches: list[Positive] | None = None

    @model_validator(mode="after")
    def _one_kind(self):
        synthetic = {"geometry": self.geometry, "matrix": self.matrix, "loads": self.loads or None}
        if self.specimen:
            given = [key for key, value in synthetic.items() if value]
            if given or self.inclusion or self.noise:
                raise ValueError("a specimen has no geometry, materials, loads or noise of its own")
        else:
            missing = [key for key, value in synthetic.items() if not value]
            if missing:
                raise ValueError(f"a synthetic case also needs {', '.join(missing)} (or name a specimen)")
        return self


class Grid(Section):
    """A product of lists: one case for every combination, named by the template ``name``.

    A value that is a list of names is swept; the template refers to it by its key, for example
    ``{geometry}_{noise}``. ``loads`` and ``methods`` are not swept: they are lists already.
    """

    name: str
    geometry: Union[str, list[str]]
    inclusion: Union[str, list[str], None] = None
    matrix: Union[str, list[str]]
    noise: Union[str, list[str], None] = None
    loads: list[str]
    methods: list[str] = Field(min_length=1)
    cells: tuple[Count, Count] = (50, 50)
    size: tuple[Positive, Positive] = (1.0, 1.0)


class Figure(Section):
    """A figure of one run: ``kind`` names its layout."""

    kind: Literal["identification"]
    case: str
    method: str
    step: int = -1


class Config(Section):
    """The whole configuration; cases of grid blocks are in ``cases`` once loaded."""

    geometries: dict[str, Geometry] = {}
    materials: dict[str, Material] = {}
    loads: dict[str, Load] = {}
    noise: dict[str, Noise] = {}
    methods: dict[str, Method] = {}
    specimens: dict[str, Specimen] = {}
    cases: dict[str, Case] = {}
    grid: list[Grid] = []
    figures: dict[str, Figure] = {}


def _expand(grid: Grid) -> dict[str, Case]:
    swept = {
        key: value if isinstance(value, list) else [value]
        for key in ("geometry", "inclusion", "matrix", "noise")
        if (value := getattr(grid, key)) is not None
    }
    cases = {}
    for combination in itertools.product(*swept.values()):
        chosen = dict(zip(swept, combination, strict=True))
        shared = {key: getattr(grid, key) for key in ("loads", "methods", "cells", "size")}
        try:
            name = grid.name.format(**chosen)
        except (KeyError, IndexError, AttributeError) as error:
            raise ValueError(f"the name '{grid.name}' refers to {error}; allowed are {', '.join(swept)}") from None
        if name in cases:
            raise ValueError(f"the name '{grid.name}' gives '{name}' twice; put every swept key into it")
        cases[name] = Case(**chosen, **shared)
    return cases


def _references(config: Config):
    """(path, name, section, names in it) for every name that one part of the config uses of another."""
    for name, case in config.cases.items():
        at = f"cases.{name}"
        for key, section in (
            ("geometry", "geometries"),
            ("inclusion", "materials"),
            ("matrix", "materials"),
            ("noise", "noise"),
            ("specimen", "specimens"),
        ):
            if getattr(case, key) is not None:
                yield f"{at}.{key}", getattr(case, key), section, getattr(config, section)
        for index, value in enumerate(case.loads):
            yield f"{at}.loads.{index}", value, "loads", config.loads
        for index, value in enumerate(case.methods):
            yield f"{at}.methods.{index}", value, "methods", config.methods
    for name, figure in config.figures.items():
        yield f"figures.{name}.case", figure.case, "cases", config.cases
        if figure.case in config.cases:
            yield f"figures.{name}.method", figure.method, "methods of its case", config.cases[figure.case].methods


def _near(value, allowed) -> str:
    near = difflib.get_close_matches(str(value), [str(a) for a in allowed], 1, cutoff=0.5)
    return f"; did you mean '{near[0]}'?" if near else ""


class _UniqueKeyLoader(yaml.SafeLoader):
    """Safe YAML that refuses a key written twice, which YAML would silently let the last one win."""

    def construct_mapping(self, node, deep=False):
        seen = set()
        for key_node, _ in node.value:
            # Entries merged in by '<<' come from elsewhere in the file and may be overridden.
            own = node.start_mark.index <= key_node.start_mark.index < node.end_mark.index
            if not own or key_node.tag == "tag:yaml.org,2002:merge":
                continue
            key = self.construct_object(key_node, deep=True)
            if key in seen:
                raise yaml.constructor.ConstructorError(
                    None, None, f"the key '{key}' is written twice", key_node.start_mark
                )
            seen.add(key)
        return super().construct_mapping(node, deep)


def _line(root: yaml.Node | None, path) -> int | None:
    """Line (from 1) of a key path in a parsed YAML document, as deep as the path exists."""
    node, line = root, None
    for part in path:
        if isinstance(node, yaml.MappingNode):
            found = [(k, v) for k, v in node.value if k.value == str(part)]
            if not found:
                break
            line, node = found[0][0].start_mark.line + 1, found[0][1]
        elif isinstance(node, yaml.SequenceNode) and isinstance(part, int) and part < len(node.value):
            node = node.value[part]
            line = node.start_mark.line + 1
    return line


def _describe(error, root, source) -> str:
    """One validation error as 'file:line: path = value: what is wrong, what is allowed'."""
    path = [part for part in error["loc"] if not (isinstance(part, str) and part.startswith("function-"))]
    # Pydantic adds the tag of a union to the path; it is not a key of the file.
    written = [part for i, part in enumerate(path) if not (i == 2 and path[0] == "geometries")]
    line = _line(root, written)
    where = f"{source}:{line}" if line else str(source)
    key = ".".join(str(part) for part in written)
    kind, context = error["type"], error.get("ctx", {})
    if kind == "extra_forbidden":
        names = _allowed_keys(Config, path[:-1])
        return f"{where}: {key}: unknown key{_near(written[-1], names)}\n    allowed: {', '.join(names)}"
    message = error["msg"].removeprefix("Value error, ")
    value = error.get("input")
    shown = f" = {value!r}" if not isinstance(value, (dict, BaseModel)) and kind != "missing" else ""
    if kind in ("literal_error", "union_tag_invalid"):
        allowed = re.findall(r"'([^']*)'", str(context.get("expected", context.get("expected_tags", ""))))
        given = context.get("tag", value)
        at = f"{key}{shown}" if kind == "literal_error" else f"{key}.shape = {given!r}"
        return f"{where}: {at}: not allowed{_near(given, allowed)}\n    allowed: {', '.join(allowed)}"
    if kind == "missing":
        message = "this key is required"
    return f"{where}: {key}{shown}: {message[0].lower() + message[1:]}"


def _allowed_keys(annotation, path) -> list[str]:
    """Keys of the section at ``path`` of the schema, through dictionaries, lists and tagged unions."""
    sections = [a for a in _flatten(annotation) if isinstance(a, type) and issubclass(a, BaseModel)]
    if not path:
        return list(dict.fromkeys(key for section in sections for key in section.model_fields))
    part, rest = path[0], path[1:]
    for section in sections:
        tag = section.model_fields.get("shape")
        if tag is not None and part in get_args(tag.annotation):
            return _allowed_keys(section, rest)
        if part in section.model_fields and annotation is section:
            return _allowed_keys(section.model_fields[part].annotation, rest)
    # The name of an entry in a dictionary, or the index in a list: step over it.
    inner = annotation if get_args(annotation) == () else get_args(annotation)[-1]
    return _allowed_keys(inner, rest)


def _flatten(annotation):
    args = get_args(annotation)
    return [annotation] if not args else [leaf for arg in args for leaf in _flatten(arg)]


def load_config(path: str | Path) -> Config:
    """Read and check a configuration file.

    Args:
        path: a YAML file.

    Returns:
        The configuration with every grid block expanded into its cases.

    Raises:
        ConfigError: the file cannot be read, is not YAML, or breaks the schema. The message names
            the file, the line, the key path, the value and what is allowed, one error a paragraph.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: cannot be read: {error}") from None
    try:
        raw = yaml.load(text, Loader=_UniqueKeyLoader)  # noqa: S506 - a SafeLoader
        root = yaml.compose(text, Loader=yaml.SafeLoader)
    except (yaml.YAMLError, RecursionError, TypeError, ValueError) as error:
        mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
        line = f":{mark.line + 1}" if mark else ""
        raise ConfigError(f"{path}{line}: not valid YAML: {getattr(error, 'problem', error)}") from None
    return check_config(raw, source=path, root=root)


def check_config(raw, source="config", root=None) -> Config:
    """Check a parsed configuration; see :func:`load_config`."""
    if not isinstance(raw, dict):
        raise ConfigError(f"{source}: the configuration must be a mapping of sections, not {type(raw).__name__}")
    problems = []
    for section, entries in raw.items():
        if isinstance(entries, dict):
            problems += [
                f"{source}:{_line(root, (section, name)) or '?'}: {section}.{name}: names use letters, digits, "
                "'_', '-' and '.', and start with a letter or digit"
                for name in entries
                if not (isinstance(name, str) and NAME.match(name))
            ]
    if problems:
        raise ConfigError("\n".join(problems))
    try:
        config = Config.model_validate(raw)
    except ValidationError as failed:
        raise ConfigError("\n".join(_describe(e, root, source) for e in failed.errors())) from None
    cases = dict(config.cases)
    for index, grid in enumerate(config.grid):
        where = f"{source}:{_line(root, ('grid', index)) or '?'}: grid.{index}"
        try:
            expanded = _expand(grid)
        except ValueError as error:
            raise ConfigError(f"{where}: {error}") from None
        for name in expanded:
            if name in cases:
                raise ConfigError(f"{where}: it makes a case '{name}', which exists already")
            if not NAME.match(name):
                raise ConfigError(f"{where}: '{name}' is no valid case name")
        cases |= expanded
    config = config.model_copy(update={"cases": cases})
    if not cases:
        raise ConfigError(f"{source}: there is no case: add one under 'cases' or 'grid'")
    for at, name, section, names in _references(config):
        if name not in names:
            line = _line(root, at.split("."))
            where = f"{source}:{line}" if line else str(source)
            hint = f"{_near(name, names)}\n    allowed: {', '.join(names) or '(none)'}"
            raise ConfigError(f"{where}: {at} = {name!r}: no such entry in {section}{hint}")
    for name, case in cases.items():
        if not case.methods:
            raise ConfigError(f"{source}: cases.{name}.methods: list at least one method ({', '.join(config.methods)})")
        if case.inclusion is None and not case.specimen and config.geometries[case.geometry].shape != "uniform":
            raise ConfigError(f"{source}: cases.{name}: the geometry '{case.geometry}' needs an inclusion material")
    return config


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
