"""The material at a point as a sum of neural-ODE terms (``eq_strain energy density function_general``)."""

import dataclasses
from dataclasses import dataclass

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from hypernode.mechanics.kinematics import in_plane_trace, stretch_powers
from hypernode.networks.potentials import POTENTIALS, Potential
from hypernode.networks.terms import INVARIANTS, POWERS, TERMS

#: Where the logit of a mixture begins: fibres with little dispersion, two families that are not coupled. What one test
#: tells of a mixture is little, and it stays near its start.
MIXTURE_START = {"I1": -2.0, "I4v": 4.0}
#: What the constant part of dPsi/dI begins with.
CONSTANT_START = {"I1": 0.4, "I2": 0.05} | dict.fromkeys(POWERS, 0.02)
#: Cost of one unit of stress of a further contribution, beside the squares of weights, in the plainness prior.
AMOUNT_COST = 0.3


@dataclass(frozen=True, kw_only=True)
class NodeMaterial:
    """Which terms a material has and how its parameters are laid out in one vector.

    The parameters at a point begin with the neural-ODE weights of each term and one mixture logit for each
    two-invariant term. Logarithms follow: of the constant parts of dPsi/dI1, dPsi/dI2 and the derivatives by sums of
    powers (where those terms exist), and of the terms' shares (where those are scaled). The fibre angle is last (where
    a fibre term exists).

    Without the term J the sheet is incompressible. With it the energy, whatever the thickness does, is a sum of
    functions of tr C - 2 and of J in the plane. A constant part c of dPsi/dI1 brings -2 c J, so that the undeformed
    sheet is free of stress. Then c (tr C - 2 J) is the energy of shear alone, and the term J that of area. Its neural
    ODE acts on (1 - J^-3) / 3, which is its derivative where the sheet keeps its volume and is neo-Hookean. On J - 1
    it would be odd, and no area resists its growth as it does its loss.

    Attributes:
        terms: names in :data:`TERMS`.
        hidden: hidden widths of every neural ODE.
        steps: RK4 steps.
        invariant_scale: what I - I(F = I) is divided by before it enters a neural ODE.
        stress_scale: unit of dPsi/dI inside the networks, in the stress unit of the data.
        share: share of a neural ODE's output in dPsi/dI. Below one, a neural ODE whose weights are small (h(1) close to
            h(0)) is a mild stiffening on top of the constant parts. The prior of small weights then means a nearly
            neo-Hookean material.
        scaled: whether each term's share is a parameter of the point, beginning at ``share``. A term that
            a point does not need then fades, which its weights alone achieve only by growing large.
        potential: what a term's increasing function is, a name in
            :data:`~hypernode.networks.potentials.POTENTIALS`; the text above says "neural ODE" for all.
    """

    terms: tuple[str, ...]
    hidden: tuple[int, ...]
    steps: int
    invariant_scale: float | Float[Array, "1"]
    stress_scale: float | Float[Array, "1"]
    share: float = 0.1
    scaled: bool = False
    potential: str = "node"

    def with_units_as_data(self) -> "NodeMaterial":
        """The same material whose two units are arrays, so that it is compiled once whatever they are."""
        return dataclasses.replace(self, **self.units_as_data)

    @property
    def units_as_data(self) -> dict[str, Array]:
        """The two units as arrays, for a compiled function to take as arguments."""
        return {key: jnp.full(1, getattr(self, key), jnp.float32) for key in ("invariant_scale", "stress_scale")}

    @property
    def _function(self) -> Potential:
        return POTENTIALS[self.potential]

    @property
    def weights_per_term(self) -> int:
        """Number of weights of one term's increasing function."""
        return self._function.weight_count(self.hidden)

    @property
    def mixtures(self) -> tuple[str, ...]:
        """The two-invariant terms."""
        return tuple(term for term in self.terms if len(TERMS[term]) == 2)

    @property
    def constants(self) -> tuple[str, ...]:
        """The invariants whose derivative has a constant part."""
        return tuple(name for name in CONSTANT_START if name in self.terms)

    @property
    def compressible(self) -> bool:
        """Whether the area of the sheet has an energy of its own."""
        return "J" in self.terms

    @property
    def has_fibres(self) -> bool:
        """Whether any term sees a fibre direction."""
        return any("I4" in term for term in self.terms)

    @property
    def size(self) -> int:
        """Length of the parameter vector at a point: the hyper-network's output width."""
        return len(self.terms) * self.weights_per_term + len(self.mixtures) + self._logarithms + int(self.has_fibres)

    @property
    def _logarithms(self) -> int:
        return len(self.constants) + (len(self.terms) if self.scaled else 0)

    def split(self, node_params: Float[Array, "size ..."]):
        """(weights[k, term, ...], mixture logits[m, ...], logarithms[c, ...], fibre angle[...])."""
        k, n, m, c = self.weights_per_term, len(self.terms), len(self.mixtures), self._logarithms
        batch = node_params.shape[1:]
        weights = node_params[: k * n].reshape(k, n, *batch)
        mixture = node_params[k * n : k * n + m]
        constants = node_params[k * n + m : k * n + m + c]
        angle = node_params[-1] if self.has_fibres else jnp.zeros(batch, node_params.dtype)
        return weights, mixture, constants, angle

    def join(self, weights, mixture, constants, angle) -> Float[Array, "size ..."]:
        """Inverse of :meth:`split`."""
        batch = weights.shape[2:]
        parts = [weights.reshape(-1, *batch), mixture, constants]
        return jnp.concatenate(parts + ([angle[None]] if self.has_fibres else []))

    def fibre_angle(self, node_params: Float[Array, "size ..."]) -> Float[Array, "..."]:
        """Angle of the first fibre direction from the x axis [rad]."""
        return self.split(node_params)[3]

    def energy_derivatives(self, I, node_params: Float[Array, "size ..."]):
        """dPsi/dI_k, an :class:`~hypernode.mechanics.kinematics.Invariants`-like tuple.

        Equation ``NODE_potential`` for each term. A term with a fibre invariant acts in tension
        only: its argument is clamped at zero below, which keeps the energy convex. So is tr C - 2 of a
        compressible sheet, as in the convex basis: where it is negative, a slope of its own would not be polyconvex.

        Args:
            I: named tuple of invariants, each of shape [..., point].
            node_params: parameters [size, point] or [size, ..., point].
        """
        weights, mixture, constants, _ = self.split(node_params)
        alpha = jax.nn.sigmoid(mixture)
        shifted = {name: getattr(I, name) - value for name, value in INVARIANTS.items()}
        if self.compressible:
            shifted |= {"I1": in_plane_trace(I) - 2.0, "J": (1.0 - I.J**-3) / 3.0}
        powers = {name: power for name, power in stretch_powers(I).items() if name in self.terms}
        shifted |= {name: value for name, (value, _, _) in powers.items()}
        inputs, shares = [], []
        for term in self.terms:
            names = TERMS[term]
            share = (1.0,)
            if len(names) == 2:
                a = alpha[self.mixtures.index(term)]
                share = (a, 1.0 - a)
            value = sum(s * shifted[name] for s, name in zip(share, names, strict=True))
            inputs.append(jnp.maximum(value, 0.0) if self._in_tension_only(term) else value)
            shares.append(dict(zip(names, share, strict=True)))
        # Stacked as [..., term, point] so that all terms run as one array.
        h = jnp.stack(inputs, axis=-2) / self.invariant_scale
        values = self._function.slope(h, weights, self.hidden, self.steps)
        total = {name: jnp.zeros_like(shifted["I1"]) for name in shifted}
        own = constants[len(self.constants) :]
        term_share = jnp.exp(own) if self.scaled else jnp.full(len(self.terms), self.share, own.dtype)
        for index, share in enumerate(shares):
            for name, s in share.items():
                total[name] = total[name] + term_share[index] * s * values[..., index, :]
        for name, constant in zip(self.constants, constants, strict=False):
            total[name] = total[name] + jnp.exp(constant)
        if self.compressible:
            # tr C = I1 - 1/J^2, and what keeps the undeformed sheet free of stress.
            total["J"] = total["J"] + 2.0 * total["I1"] / I.J**3 - 2.0 * jnp.exp(constants[0])
        for name, (_, by_I1, by_I2) in powers.items():
            slope = total.pop(name)
            total["I1"], total["I2"] = total["I1"] + slope * by_I1, total["I2"] + slope * by_I2
        return type(I)(**{name: self.stress_scale * value for name, value in total.items()})

    def _in_tension_only(self, term: str) -> bool:
        return "I4" in term or (self.compressible and term == "I1")

    def initial_params(self, key: Array) -> Float[Array, " size"]:
        """Random parameters of a soft, nearly neo-Hookean start; every term has its own key."""
        k = self.weights_per_term
        keys = jax.random.split(key, len(self.terms))
        spread = 0.5 / max(self.hidden) ** 0.5
        weights = spread * jax.vmap(lambda each: jax.random.normal(each, (k,)), out_axes=1)(keys)
        shares = [self.share] * len(self.terms) if self.scaled else []
        constants = jnp.log(jnp.array([CONSTANT_START[name] for name in self.constants] + shares))
        mixture = jnp.array([MIXTURE_START.get(TERMS[term][0], 0.0) for term in self.mixtures])
        return self.join(weights, mixture, constants, jnp.zeros(()))

    def departures(
        self, node_params: Float[Array, " size"], centre: Float[Array, " size"]
    ) -> Float[Array, " departure"]:
        """Numbers of one material whose squares add up to :meth:`departure`."""
        weights, _, logarithms, _ = self.split(node_params)
        _, mixture, _, angle = self.split(node_params - centre)
        amounts = jnp.sqrt(AMOUNT_COST) * jnp.exp(0.5 * logarithms[1:])
        return jnp.concatenate([weights.ravel(), mixture, amounts, angle[None]])

    def departure(self, node_params: Float[Array, "size point"], centre: Float[Array, " size"]) -> Float[Array, ""]:
        """Mean over points of how far the material is from the plainest one, a neo-Hookean sheet.

        The sum has the squares of the neural-ODE weights, which bend the curves, and of the mixtures' and the fibre
        angle's distance from ``centre``. It also has the amount of every contribution beside the first constant: of
        several terms that explain a test alike, the fewest are used. The first constant, which carries the contrast,
        costs nothing.
        """
        weights, _, logarithms, _ = self.split(node_params)
        _, mixture, _, angle = self.split(node_params - centre[:, None])
        total = jnp.sum(weights**2, axis=(0, 1)) + jnp.sum(mixture**2, axis=0)
        total = total + AMOUNT_COST * jnp.sum(jnp.exp(logarithms[1:]), axis=0)
        return jnp.mean(total + (angle**2 if self.has_fibres else 0.0))
