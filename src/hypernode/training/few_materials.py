"""The hyper-network of a field of few materials: each material fitted once, the network told where each is."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from hypernode.material.basis_file import basis_field
from hypernode.material.laws import node_stress
from hypernode.mechanics.convex_basis import FIBRE_VECTOR
from hypernode.networks.fourier_mlp import FourierMLP
from hypernode.progress import say
from hypernode.training.levenberg import least_squares
from hypernode.training.loop import Fit
from hypernode.training.problem import InverseProblem
from hypernode.training.separation import Separation, separate
from hypernode.training.targets import Target

#: Deformations of its own cells at which a material is fitted, beside the homogeneous modes: four numbers each, three
#: times as many as a material of five terms has parameters.
SAMPLES = 96
#: So many materials are few: a fit takes up to a second, a descent of the whole network fifteen.
FEW = 12
#: How far from one a network's function is at most at a cell where it should be one.
CERTAINTY = 1e-4
#: Most steps of the fit of a material.
STEPS = 60
#: Shares of the tolerated error: where a fit ends, for less is none of the field's, and beyond which another start is
#: tried.
ENOUGH, FAR = 0.02, 0.5
#: Smallest factor by which the homogenised material is scaled.
SOFTEST = 1e-4


def learn_few_materials(problem: InverseProblem, target: Target) -> Fit | None:
    """The hyper-network of a field of few materials, or None where there is no such one.

    There is none where materials are many, where the network cannot tell their regions apart, or where one of them is
    missed by more than the tolerance.

    Linear functions g_k of the Fourier features are positive in material k alone. A unit of each hidden layer gives
    tanh(b g_k), which is nearly one or minus one at every cell. The last layer makes of them theta_0 + sum over k of
    (theta_k - theta_0) (1 + tanh(b g_k)) / 2. Here theta_k are the parameters fitted to material k, theta_0 those of
    the background. Other units keep their random weights, for a later training, and do not count.
    """
    labels = problem.materials
    if labels.max() + 1 > min(FEW, *problem.method.hypernetwork.widths):
        return None
    network = problem.new_network()
    found = separate(np.asarray(network.features(problem.X), float), labels)
    if found is None:
        return None
    params, missed, losses = fit_materials(problem, target)
    if missed.max() > problem.method.pretraining.tolerance**2:
        return None
    _write_into(network, found, params)
    worst = np.sqrt(missed.max())
    say("pre-training", problem.name, f"{len(params)} materials fitted, the worst missed by {worst:.2%}")
    return Fit(network, losses, np.arange(len(losses)))


def fit_materials(problem: InverseProblem, target: Target) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Each material fitted to the stress of its cells: parameters (material, size), how far they miss, the loss.

    The loss is that of pre-training, at deformations of some of the material's own cells and at the homogeneous modes.
    Of several starts the one is kept that misses least of deformations that it was not fitted to. That squared error
    (material,) is returned, and the mean loss of all materials after every step (step,).
    """
    material, prior_weight = problem.node, problem.method.prior_weight

    def stress(params, data):
        node = dataclasses.replace(material, **data["units"])
        everywhere = jnp.broadcast_to(params[:, None], (len(params), data["F"].shape[-1]))
        return node_stress(node, data["F"], everywhere) / data["scale"]

    @jax.jit
    def scaled(params, data):
        """The same, as stiff as the target: the stress is proportional to the exponential of the logarithms."""
        P = stress(params, data)
        factor = jnp.sum(data["weight"] ** 2 * P * data["P"]) / jnp.sum((data["weight"] * P) ** 2)
        weights, mixture, logarithms, angle = material.split(params)
        return material.join(weights, mixture, logarithms + jnp.log(jnp.maximum(factor, SOFTEST)), angle)

    def residual(params, data):
        """Square roots of the terms of the loss."""
        missed = stress(params, data) - data["P"]
        departures = jnp.sqrt(prior_weight) * material.departures(params, data["centre"])
        return jnp.concatenate([(data["weight"] * missed).ravel(), departures])

    settings, held_out = problem.method.pretraining, jax.jit(residual)
    solve = least_squares(residual, STEPS, (ENOUGH * settings.tolerance) ** 2)
    draw, found = np.random.default_rng(problem.method.seed), []
    for k in range(problem.materials.max() + 1):
        cells = np.flatnonzero(problem.materials == k)
        seen, unseen = (
            {**_samples(target, problem.F.shape[2], cells, draw), "units": material.units_as_data} for _ in range(2)
        )
        tried = []
        for number in range(settings.rounds):
            start = scaled(_start(problem, number, cells[0]), seen)
            params, squares = solve(start, {**seen, "centre": start})
            missed = held_out(jnp.asarray(params, jnp.float32), {**unseen, "centre": start})
            tried.append((float(missed @ missed), params, squares))
            if tried[-1][0] <= (FAR * settings.tolerance) ** 2:
                break
        found.append(min(tried, key=lambda each: each[0]))
    missed, params, histories = zip(*found, strict=True)
    longest = max(map(len, histories))
    losses = np.mean([np.pad(each, (0, longest - len(each)), mode="edge") for each in histories], axis=0)
    return np.stack(params), np.array(missed), losses.astype(np.float32)


def _start(problem: InverseProblem, number: int, cell: int) -> jax.Array:
    """Where a fit begins: the homogenised parameters, or random ones where these led to no good end.

    They are turned to where the field has the fibres of the cell, for no descent turns far.
    """
    start = problem.centre if number == 0 else problem.node.initial_params(jax.random.key(problem.method.seed + number))
    basis, params = basis_field(problem.inputs["constrained"])
    if not (basis.has_fibres and problem.node.has_fibres):
        return start
    x, y = (params[basis.names.index(name), 0, cell] for name in FIBRE_VECTOR)
    return start.at[-1].set(0.5 * np.arctan2(y, x))


def _samples(target: Target, steps: int, cells, draw) -> dict[str, jax.Array]:
    """Deformations of some of the cells in the first cases, and the other cases once, with their weights."""
    case, cell = draw.integers(steps, size=SAMPLES), draw.choice(cells, SAMPLES)
    modes = np.arange(steps, target.F.shape[2])
    case, cell = np.concatenate([case, modes]), np.concatenate([cell, np.full(len(modes), cells[0])])
    # The loss is a mean over cases, whatever the number of samples of one, and over four components.
    share = np.concatenate([np.full(SAMPLES, steps / SAMPLES), np.ones(len(modes))]) / target.F.shape[2]
    return {
        "F": target.F[:, :, case, cell],
        "P": target.P[:, :, case, cell],
        "scale": target.scale[case],
        "weight": jnp.asarray(np.sqrt(share / 4.0), jnp.float32),
    }


def _write_into(network: FourierMLP, found: Separation, params: Float[np.ndarray, "material size"]) -> None:
    """Give the first units of every layer what tells materials apart, and the last layer what they are."""
    count, saturated = len(found.regions), float(np.arctanh(1.0 - CERTAINTY))
    halves = 0.5 * (params[found.regions] - params[found.background])
    first, *others, last = network.layers
    told = [
        jnp.asarray(saturated / found.margins * part, jnp.float32) for part in (found.weights[:-1], found.weights[-1])
    ]
    first.kernel[...] = first.kernel[...].at[:, :count].set(told[0])
    first.bias[...] = first.bias[...].at[:count].set(told[1])
    for layer in others:
        layer.kernel[...] = (
            layer.kernel[...].at[:, :count].set(saturated * jnp.eye(layer.kernel.shape[0], count, dtype=jnp.float32))
        )
        layer.bias[...] = layer.bias[...].at[:count].set(0.0)
    last.kernel[...] = jnp.zeros_like(last.kernel[...]).at[:count].set(jnp.asarray(halves, jnp.float32))
    last.bias[...] = jnp.asarray(params[found.background] + halves.sum(axis=0), jnp.float32)
