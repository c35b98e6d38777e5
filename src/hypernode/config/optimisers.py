"""How the stages of a method are trained."""

from typing import Literal

from hypernode.config.section import Count, NonNegative, NonNegativeInt, Positive, Section


class Optimiser(Section):
    """How a stage is trained."""

    iterations: NonNegativeInt
    """Number of iterations; a stage of the hyper-network with 0 is left out."""
    learning_rate: Positive = 0.01
    """Learning rate of the first iteration."""
    algorithm: Literal["adam", "muon"] = "muon"
    """Optimiser; Muon needs fewer iterations for the same loss (docs/decisions/0006)."""
    points: Count | None = None
    """Points drawn anew in each iteration; left out, what the stage is used to."""


class Homogenisation(Optimiser):
    """The stage that fits one material to the whole sheet."""

    ridge: NonNegative = 1e-6
    """Cost of the squared weights and of how far the constants come away from their start: of the many materials that
    fit, the plainest."""


class Initialisation(Optimiser):
    """The stage in which the hyper-network learns that material everywhere."""

    from_bias: bool = True
    """Whether the last layer begins with that material as its bias and with a small kernel, so that little is left to
    learn; otherwise all weights begin at random."""


class Pretraining(Optimiser):
    """The stage in which the hyper-network learns a target everywhere."""

    tolerance: Positive = 0.006
    """Relative error of the stress against that of the constrained field, in its worst load step or mode, beyond which
    Gauss-Newton steps go on, and then another training begins from other random weights. The best is kept."""
    rounds: Count = 3
    """How often it is trained at most."""


class Polish(Section):
    """The stage in which the pre-trained network itself is brought to explain displacements and forces."""

    iterations: NonNegativeInt = 12
    """Largest number of Gauss-Newton steps; with 0 the network is judged on the held-out load steps, and left as it
    is."""
    deviation: Positive = 0.1
    """How far, relative, the stress under homogeneous deformations may come away from that of the pre-trained network:
    its standard deviation before the data are seen."""
    tolerance: Positive = 2e-4
    """It ends where a step lowers the cost by less than this times what noise alone costs."""
