"""The schema of the configuration.

A configuration names geometries, materials, loads, noise levels, methods and specimens; ``cases``
combine them and ``grid`` blocks expand products of them into more cases.
"""

import difflib
from typing import Annotated, Literal, Union, get_args

from pydantic import BaseModel, ConfigDict, Field, model_validator

from hypernode.mechanics.loads import CONSTRAINED
from hypernode.mechanics.material_names import BASIS_TERMS, PARAMETERS
from hypernode.networks.terms import POTENTIAL_NAMES, TERMS

LoadKind = Literal["equibiaxial", "biaxial", "uniaxial_x", "uniaxial_y", "clamped_x", "clamped_y", "shear"]
assert set(get_args(LoadKind)) == set(CONSTRAINED), "the schema lists every load kind"

Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]
Fraction = Annotated[float, Field(ge=0, le=1)]
Count = Annotated[int, Field(ge=1)]
Point = tuple[float, float]


class Section(BaseModel):
    """A mapping with a fixed set of keys."""

    model_config = ConfigDict(extra="forbid", strict=False, frozen=True)


class Glyph(Section):
    """A letter, digit or word drawn from DejaVu Sans."""

    model_config = ConfigDict(coerce_numbers_to_str=True)

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
        if not isinstance(values, dict) or str(values.get("model")) not in PARAMETERS:
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
    """The neural ODEs of a material point.

    ``share`` is what a neural ODE's output counts beside the constant part of dPsi/dI: small where the
    prior must keep curves plain; with ``scaled`` it is one more parameter a term and point.
    ``potential`` replaces the neural ODEs by input-convex networks (icnn) or sums of powers and exponentials (cann,
    to which ``hidden`` means nothing).
    """

    terms: list[Literal[tuple(TERMS)]] = Field(min_length=1)
    hidden: list[Count] = Field(min_length=1)
    rk4_steps: Count = 2
    share: Annotated[float, Field(gt=0, le=1)] = 0.1
    scaled: bool = False
    potential: Literal[POTENTIAL_NAMES] = "node"

    @model_validator(mode="after")
    def _once(self):
        if len(set(self.terms)) != len(self.terms):
            raise ValueError("a term is listed twice")
        if "I1" not in self.terms and "I2" not in self.terms:
            raise ValueError(
                "terms need I1 or I2: a material without an isotropic part has no stiffness across its fibres"
            )
        if "J" in self.terms and ("I1" not in self.terms or any("I2" in term for term in self.terms)):
            raise ValueError("terms with J need I1 and no I2: I2 needs the thickness, which J leaves open")
        return self


class Training(Optimiser):
    """The last stage: equilibrium and edge resultants together.

    ``equilibrium`` names how the residual is formed and measured: ``strong`` (finite-difference
    divergence on the measured grid) or ``autodiff`` (exact derivative of the interpolated fields),
    both as mean squares at points; or ``equilibrated`` (distance from the nearest equilibrated stress).
    ``batch_mean`` and ``wrong_index`` are ``autodiff`` with a slip each, kept as ablations: the square of the
    mean over the points, and the divergence of the transposed stress.
    ``target_weight`` keeps the target of the pre-training (the stress of the constrained field, or the
    uniform stress) beside it, which decides among the stress fields that one noisy test cannot tell apart.
    ``variation_weight`` is the cost of the stress's total variation under the sheet's mean deformation.
    """

    equilibrium: Literal["strong", "autodiff", "equilibrated", "batch_mean", "wrong_index"] = "equilibrated"
    equilibrium_weight: NonNegative = 1.0
    force_weight: NonNegative = 1.0
    target_weight: NonNegative = 0.0
    variation_weight: NonNegative = 0.0


class Constrained(Section):
    """Equilibrium as a constraint: the field of convex-basis coefficients that explains the test.

    ``further_terms`` are tried beside ``terms`` where those do not explain the test.
    ``jump_weight`` is the cost of a jump of the field against misfits in units of their noise;
    jumps of the logarithm of the stiffness above ``jump_scale`` stop costing more. It ends where the cost
    falls by less than ``tolerance`` times what noise alone costs in one of at most ``iterations``. ``force_noise`` is
    the relative error of the load cell. ``draws`` is how many fields that the test cannot tell from the best one are
    kept, from ``seed``, where the displacements have noise: they say how uncertain it is.
    """

    terms: list[Literal[BASIS_TERMS]] = ["I1_squared", "I2", "fibre", "stiffening"]
    further_terms: list[Literal[BASIS_TERMS]] = []
    iterations: Count = 60
    jump_weight: Positive = 25.0
    jump_scale: Positive = 0.05
    force_noise: Positive = 6e-4
    tolerance: Positive = 2e-4
    draws: Annotated[int, Field(ge=0)] = 0
    seed: Annotated[int, Field(ge=0)] = 0

    @model_validator(mode="after")
    def _first_terms_first(self):
        every = {*self.terms, *self.further_terms}
        for term, of in (("across", "fibre"), ("stiffening", "fibre"), ("I1_stiffening", "I1_squared")):
            if term in every and of not in self.terms:
                raise ValueError(f"the term {term} says more of the term {of}: add {of} to terms")
        if "J" in self.further_terms or ("J" in self.terms and "I2" in every):
            raise ValueError("the term J belongs to terms, without I2: I2 needs the thickness, which J leaves open")
        return self


class Method(Section):
    """Everything that turns a measurement into a material.

    With a ``constrained`` section, displacements are first replaced by the equilibrium field that
    explains them, and the networks learn its stress; without an ``interpolant`` they see the
    deformation gradient of the grid itself.

    A ``baseline`` ends without networks: ``homogeneous`` (one neo-Hookean modulus from the forces),
    ``equilibrium_gap`` (a modulus a cell, for which the measured deformation is in equilibrium), or
    ``constrained`` (the field of that section itself).
    """

    baseline: Literal["homogeneous", "equilibrium_gap", "constrained"] | None = None
    constrained: Constrained | None = None
    gradient: Literal["element", "finite_difference"] = "element"
    interpolant: Interpolant | None = None
    node: Node | None = None
    hypernetwork: Frequencies | None = None
    homogenised: Optimiser | None = None
    initialisation: Optimiser | None = None
    pretraining: Optimiser | None = None
    training: Training | None = None
    prior_weight: NonNegative = 1e-3
    seed: int = Field(default=0, ge=0)

    @model_validator(mode="after")
    def _stages(self):
        stages = ("node", "hypernetwork", "homogenised", "initialisation", "pretraining", "training")
        if self.baseline:
            idle = [key for key in (*stages, "interpolant") if getattr(self, key) is not None]
            if idle:
                raise ValueError(f"a baseline has no networks: leave out {', '.join(idle)}")
            if (self.constrained is None) == (self.baseline == "constrained"):
                raise ValueError("the section constrained goes with baseline 'constrained', and only with that one")
            return self
        missing = [key for key in stages if getattr(self, key) is None]
        if missing:
            raise ValueError(f"a method also needs {', '.join(missing)} (or name a baseline)")
        if self.interpolant is None and self.training.equilibrium in ("autodiff", "batch_mean", "wrong_index"):
            raise ValueError(
                f"training.equilibrium '{self.training.equilibrium}' needs an interpolant: only that can be "
                "differentiated"
            )
        if self.constrained and ("J" in self.constrained.terms) != ("J" in self.node.terms):
            raise ValueError(
                "J is in the terms of one of constrained and node only: the networks learn what the equilibrium "
                "field found, so that both or neither must be compressible"
            )
        return self


class Specimen(Section):
    """A real test: where its files are and how to read them.

    Lengths in mm, times in s, forces in N. Either ``frames`` (numbers) or ``stretches`` (target
    mean stretches along the tensile axis) selects the load steps. ``force_offset`` is subtracted from the force
    record: what it reads before the sheet pulls. ``force_uncertainty``: of the force that the grid carries, relative:
    the load cell's, and that of the share of the sheet's width that is left of it. ``relaxation``: tell from the
    record which share of the force is a matter of time, and identify without it. ``correlation_window`` is the
    side of the window over which the cameras' software averages the displacement, 0 where it is not known.
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
    force_offset: float = 0.0
    force_uncertainty: Fraction = 0.01
    relaxation: bool = True
    edge_ring: Annotated[int, Field(ge=0)] = 1
    frames: list[Count] | None = None
    stretches: list[Annotated[float, Field(gt=1)]] | None = None
    noise_pixels: Positive = 0.3
    correlation_window: NonNegative = 0.0
    shape_image: str | None = None
    shape_flipped: bool = False
    source_title: str = ""

    @model_validator(mode="after")
    def _selection(self):
        if (self.frames is None) == (self.stretches is None):
            raise ValueError("give either frames or stretches")
        return self


class Layer(Section):
    """A further phase, drawn over what is already there."""

    geometry: str
    material: str


class Camera(Section):
    """A measured grid of its own: so that data and identification do not share a mesh.

    ``cells`` of the measured grid, and ``window``, the side of the correlation window over which the
    displacement is averaged, in the length unit of the sheet.
    """

    cells: tuple[Count, Count]
    window: NonNegative = 0.0


class Case(Section):
    """One sheet and its tests: a synthetic one (geometry, materials, loads) or a specimen.

    ``hole`` names a geometry where there is no material; ``layers`` are phases drawn over the first
    two; ``spacing`` is the ratio of the last to the first cell's side along x and y; ``camera`` measures
    on a grid that is not the finite-element mesh. ``unseen_loads`` are computed with the identified
    field and compared with the truth. ``references`` of a specimen: phase -> case of a sheet that consists of
    it, whose forces are compared with those of the identified phase, or whole -> case of frames that were not used.
    """

    geometry: str | None = None
    inclusion: str | None = None
    matrix: str | None = None
    loads: list[str] = []
    noise: str | None = None
    specimen: str | None = None
    layers: list[Layer] = []
    hole: str | None = None
    cells: tuple[Count, Count] = (50, 50)
    size: tuple[Positive, Positive] = (1.0, 1.0)
    spacing: tuple[Positive, Positive] = (1.0, 1.0)
    camera: Camera | None = None
    unseen_loads: list[str] = []
    references: dict[Literal["matrix", "inclusion", "whole"], str] = {}
    methods: list[str] = []
    judged_stretches: list[Positive] | None = None

    @model_validator(mode="after")
    def _one_kind(self):
        synthetic = {"geometry": self.geometry, "matrix": self.matrix, "loads": self.loads or None}
        if self.specimen:
            given = [key for key, value in synthetic.items() if value]
            if given or self.inclusion or self.noise or self.layers or self.hole or self.camera or self.unseen_loads:
                raise ValueError("a specimen has no geometry, materials, loads or noise of its own")
        else:
            if self.references:
                raise ValueError("references are for specimens: a synthetic case is compared with its truth")
            missing = [key for key, value in synthetic.items() if not value]
            if missing:
                raise ValueError(f"a synthetic case also needs {', '.join(missing)} (or name a specimen)")
            if self.camera and self.hole:
                raise ValueError("a camera grid cannot be laid over a sheet with a hole")
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
    hole: str | None = None
    cells: tuple[Count, Count] = (50, 50)
    size: tuple[Positive, Positive] = (1.0, 1.0)
    spacing: tuple[Positive, Positive] = (1.0, 1.0)
    camera: Camera | None = None


class RunFigure(Section):
    """A figure of one run: ``kind`` names its layout, ``step`` the load step drawn."""

    kind: Literal["identification", "anisotropy", "overview", "references"]
    case: str
    method: str
    step: int = -1


class ShownRun(Section):
    """A row of a comparison: a run, or what one of its stages left."""

    case: str
    method: str
    stage: Literal["constrained", "initialised", "pretrained", "material"] = "material"
    label: str


class Comparison(Section):
    """A figure of several runs: their fields, or the fields' errors, at several stretches."""

    kind: Literal["comparison"]
    runs: list[ShownRun] = Field(min_length=1)
    stretches: list[Positive] = Field(min_length=1)
    load: LoadKind = "equibiaxial"
    show: Literal["stress", "error"] = "stress"


Figure = Annotated[Union[RunFigure, Comparison], Field(discriminator="kind")]


class RunTable(Section):
    """Numbers of the runs ``case/method`` that match a pattern, one by one or in groups.

    An ``ensemble`` compares the fields of the runs of each group, which are of one case.
    """

    kind: Literal["runs", "timing", "validation", "references", "ensemble"] = "runs"
    runs: list[str] = ["*"]
    columns: list[str] = []
    groups: dict[str, str] = {}


class SettingsTable(Section):
    """A section of the configuration as a table."""

    kind: Literal["settings"]
    section: Literal["materials", "loads", "methods", "noise"]


Table = Union[SettingsTable, RunTable]


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
    tables: dict[str, Table] = {}

    @model_validator(mode="after")
    def _summary(self):
        self.tables.setdefault("summary", RunTable())
        return self
