"""Methods: everything that turns a measurement into a material."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from hypernode.config.section import Count, NonNegative, Positive, Section
from hypernode.mechanics.parameters import BASIS_TERMS
from hypernode.networks.terms import POTENTIAL_NAMES, TERMS


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
    ``regulariser_weight`` is the cost of a jump of the field against misfits in units of their noise;
    jumps of the logarithm of the stiffness above ``jump_scale`` stop costing more. It ends where the cost
    falls by less than ``tolerance`` times what noise alone costs in one of at most ``iterations``. ``force_noise`` is
    the relative error of the load cell. ``posterior_samples`` is how many fields that the test cannot tell from the best one are
    kept, from ``seed``, where the displacements have noise: they say how uncertain it is.
    """

    terms: list[Literal[BASIS_TERMS]] = ["I1_squared", "I2", "fibre", "stiffening"]
    further_terms: list[Literal[BASIS_TERMS]] = []
    iterations: Count = 60
    regulariser_weight: Positive = 25.0
    jump_scale: Positive = 0.05
    force_noise: Positive = 6e-4
    tolerance: Positive = 2e-4
    posterior_samples: Annotated[int, Field(ge=0)] = 0
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
