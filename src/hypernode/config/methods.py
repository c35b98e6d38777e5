"""Methods: everything that turns a measurement into a material, stage by stage."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from hypernode.config.optimisers import Homogenisation, Initialisation, Optimiser, Polish, Pretraining
from hypernode.config.section import Count, NonNegative, NonNegativeInt, Positive, Section
from hypernode.mechanics.parameters import BASIS_TERMS
from hypernode.networks.terms import POTENTIAL_NAMES, POWERS, TERMS

#: Methods without networks.
BASELINES = (
    *("homogeneous", "virtual_fields", "equilibrium_gap", "constitutive_gap", "reciprocity_gap", "updating"),
    "constrained",
)
#: Losses that differentiate the interpolated fields at points.
POINTWISE = ("autodiff", "batch_mean", "wrong_index")


class Frequencies(Section):
    """Sizes of a network on random Fourier features."""

    features: Count
    """Number of random frequencies; each gives a sine and a cosine."""
    frequency_scale: Positive
    """Standard deviation of the frequencies: the larger, the finer what the network can resolve. That of a
    hyper-network is at most 0.175 for each cell along the longest side."""
    widths: list[Count] = Field(min_length=1)
    """Neurons of each hidden layer."""


class Interpolant(Frequencies, Optimiser):
    """The network (X, t) -> F."""


def needing_thickness(terms: list[str]) -> bool:
    """Whether one of these terms of networks contains the thickness of the sheet."""
    return any("I2" in term or term in POWERS for term in terms)


class Node(Section):
    """The neural ODEs of a material point."""

    terms: list[Literal[tuple(TERMS)]] = Field(min_length=1)
    """Arguments of the energy: invariants, mixtures of two such as I1_I4v, and J for a sheet whose volume may change
    (without I2, and in ``constrained`` alike)."""
    further_terms: list[Literal[POWERS]] = []
    """Terms that join these where the equilibrium field has ``ogden``: sums of powers of the principal stretches, which
    functions of I1 and of I2 cannot stand for."""
    hidden: list[Count] = Field(min_length=1)
    """Neurons of each hidden layer of a neural ODE."""
    rk4_steps: Count = 2
    """Runge-Kutta steps in which a neural ODE is solved."""
    share: Annotated[float, Field(gt=0, le=1)] = 0.1
    """What a neural ODE's output counts beside the constant part of dPsi/dI: small where the prior must keep curves
    plain."""
    scaled: bool = False
    """Whether the share is one more parameter of each term and point."""
    potential: Literal[POTENTIAL_NAMES] = "node"
    """Increasing functions: neural ODEs, or input-convex networks (icnn) or sums of powers and exponentials (cann, to
    which ``hidden`` means nothing) in their place."""

    @model_validator(mode="after")
    def _once(self):
        if len({*self.terms, *self.further_terms}) != len(self.terms) + len(self.further_terms):
            raise ValueError("a term is listed twice")
        if "I1" not in self.terms and "I2" not in self.terms:
            raise ValueError(
                "terms need I1 or I2: a material without an isotropic part has no stiffness across its fibres"
            )
        if "J" in self.terms and ("I1" not in self.terms or needing_thickness(self.terms)):
            raise ValueError(
                "terms with J need I1, no I2 and no powers of stretches: these need the thickness, which J leaves open"
            )
        return self


class Training(Optimiser):
    """The last stage: equilibrium and edge resultants together."""

    equilibrium: Literal["strong", "autodiff", "equilibrated", "batch_mean", "wrong_index"] = "equilibrated"
    """How the residual is formed and measured: ``strong`` (finite-difference divergence on the measured grid) or
    ``autodiff`` (exact derivative of the interpolated fields), both as mean squares at points; or ``equilibrated``
    (distance from the nearest equilibrated stress). ``batch_mean`` and ``wrong_index`` are ``autodiff`` with a slip
    each, kept as ablations: the square of the mean over the points, and the divergence of the transposed stress."""
    equilibrium_weight: NonNegative = 1.0
    """Weight of the residual."""
    force_weight: NonNegative = 1.0
    """Weight of the edge resultants."""
    target_weight: NonNegative = 0.0
    """Weight of the target of the pre-training (the stress of the constrained field, or the uniform stress), which
    decides among the stress fields that one noisy test cannot tell apart."""
    penalty: Literal["square", "absolute"] = "square"
    """What the length of the divergence at a point costs: its square, or, past a small size, itself, so that the jump
    of a material counts for less. Of ``autodiff`` and ``wrong_index``."""
    traction: Literal["resultant", "nodal"] = "resultant"
    """What is compared at the outline: the mean traction of each edge with its force over its length, or the traction
    at each node with that of the computed sheet. Of a test that knows its resultants alone, these are spread evenly
    over the nodes."""
    variation_weight: NonNegative = 0.0
    """Cost of the stress's total variation under the sheet's mean deformation."""


class Constrained(Section):
    """Equilibrium as a constraint: the field of convex-basis coefficients that explains the test."""

    terms: list[Literal[BASIS_TERMS]] = ["I1_squared", "I2", "fibre", "stiffening"]
    """Terms of the energy beside the neo-Hookean one."""
    isotropic_terms: list[Literal[BASIS_TERMS]] = []
    """Terms without fibres that are tried in place of these where these have fibres, and not used otherwise; the
    likelier field is kept."""
    further_terms: list[Literal[BASIS_TERMS]] = []
    """Terms that are tried beside these where they do not explain the test."""
    volume: Literal["kept", "told"] = "kept"
    """Whether sheets without the term J keep their volume, or the test decides between such laws and laws with J. The
    presets let it decide."""
    iterations: Count = 60
    """Largest number of iterations."""
    regulariser_weight: Positive = 25.0
    """Cost of a jump of the field against misfits in units of their noise."""
    jump_scale: Positive = 0.05
    """Jump of the logarithm of the stiffness above which a larger one costs no more."""
    force_noise: Positive = 6e-4
    """Relative error of the load cell."""
    tolerance: Positive = 2e-4
    """It ends where an iteration lowers the cost by less than this times what noise alone costs."""
    layers: bool = False
    """Whether a sheet that points measure may be of a few materials with lines between them; such a field is kept where
    it explains the test. The presets ask for it."""
    posterior_samples: NonNegativeInt = 0
    """Fields kept that the test cannot tell from the best one, by its noise or by what finite elements miss of a
    measured grid: they say how uncertain it is. None of what was computed on the grid itself, without noise."""
    seed: NonNegativeInt = 0
    """Seed of these fields."""

    @model_validator(mode="after")
    def _first_terms_first(self):
        every = {*self.terms, *self.further_terms}
        for key, given, known in (("terms", every, self.terms), ("isotropic_terms", *2 * (self.isotropic_terms,))):
            for term, of in (("across", "fibre"), ("stiffening", "fibre"), ("I1_stiffening", "I1_squared")):
                if term in given and of not in known:
                    raise ValueError(f"the term {term} says more of the term {of}: add {of} to {key}")
        if "J" in self.further_terms or ("J" in self.terms and every & {"I2", "ogden"}):
            raise ValueError(
                "the term J belongs to terms, without I2 and ogden: these need the thickness, which J leaves open"
            )
        if {"fibre", "J"} & set(self.isotropic_terms):
            raise ValueError("isotropic_terms are of a sheet without fibres and of known volume: neither fibre nor J")
        return self


class Method(Section):
    """Everything that turns a measurement into a material.

    Either all sections from ``node`` to ``training`` are given, or ``baseline``, or ``extends`` and what differs.
    """

    baseline: Literal[BASELINES] | None = None
    """A method without networks: ``homogeneous`` (one neo-Hookean modulus from the forces), ``virtual_fields`` (moduli
    of regions by sensitivity-based virtual fields), ``equilibrium_gap`` (a modulus a cell, for which the measured
    deformation is in equilibrium), ``constitutive_gap`` (a modulus a cell, closest to a stress in equilibrium),
    ``reciprocity_gap`` (the place of an inclusion from the outline), ``updating`` (moduli of regions or of cells by
    finite-element model updating), or ``constrained`` (the field of that section itself)."""
    regions: Literal["one", "two", "cells"] = "two"
    """Regions of ``virtual_fields`` and ``updating``: the sheet, its softer and its stiffer cells by the
    constitutive equation gap, or every cell."""
    constrained: Constrained | None = None
    """The equilibrium field that replaces the displacements and whose stress the networks learn; left out, the
    measurement is differentiated."""
    gradient: Literal["element", "finite_difference"] = "element"
    """How the deformation gradient of the measured grid is formed."""
    interpolant: Interpolant | None = None
    """The network that interpolates it; left out, the others see the grid's own."""
    node: Node | None = None
    """The material of a point."""
    hypernetwork: Frequencies | None = None
    """The network from a position to the parameters of its material."""
    homogenised: Homogenisation | None = None
    """First stage: one material for the whole sheet."""
    initialisation: Initialisation | None = None
    """Second stage: the hyper-network learns that material everywhere."""
    pretraining: Pretraining | None = None
    """Third stage: it learns the stress of the constrained field, or a uniform one."""
    polish: Polish | None = None
    """Stage after pre-training: the network itself is brought to explain displacements and forces in finite-element
    equilibrium, and is kept if load steps that it did not see agree better; left out, it stays as it is."""
    training: Training | None = None
    """Last stage: equilibrium and edge forces."""
    normalised: bool = True
    """Whether deformations, invariants and stresses are divided by their size, so that every load step counts the
    same; otherwise all are as they are, in the units of the test."""
    prior_weight: NonNegative = 1e-3
    """Cost of materials that differ from plain ones (docs/decisions/0004)."""
    seed: NonNegativeInt = 0
    """Seed of the networks."""

    @model_validator(mode="after")
    def _stages(self):
        stages = ("node", "hypernetwork", "homogenised", "initialisation", "pretraining", "training")
        if self.baseline:
            idle = [key for key in (*stages, "interpolant", "polish") if getattr(self, key) is not None]
            if idle:
                raise ValueError(f"a baseline has no networks: leave out {', '.join(idle)}")
            if (self.constrained is None) == (self.baseline == "constrained"):
                raise ValueError("the section constrained goes with baseline 'constrained', and only with that one")
            return self
        missing = [key for key in stages if getattr(self, key) is None]
        if missing:
            raise ValueError(f"a method also needs {', '.join(missing)} (or name a baseline)")
        if self.interpolant is None and self.training.equilibrium in POINTWISE:
            raise ValueError(
                f"training.equilibrium '{self.training.equilibrium}' needs an interpolant: only that can be "
                "differentiated"
            )
        if self.training.traction == "nodal" and self.training.equilibrium not in POINTWISE:
            raise ValueError(
                "training.traction 'nodal' goes with a residual at points, training.equilibrium "
                f"{' or '.join(POINTWISE)}"
            )
        if self.polish and (not self.constrained or not self.pretraining.iterations or self.training.iterations):
            raise ValueError(
                "polish goes on from a network that pre-training taught an equilibrium field: it needs the section "
                "constrained, iterations in pretraining, and none in training"
            )
        if self.constrained and ("J" in self.constrained.terms) != ("J" in self.node.terms):
            raise ValueError(
                "J is in the terms of one of constrained and node only: the networks learn what the equilibrium "
                "field found, so that both or neither must be compressible"
            )
        return self
