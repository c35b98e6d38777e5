"""Time of one main-training gradient step against the algorithm of the published code, in one run.

The published algorithm is re-created here from its description: double precision, the divergence by
four reverse-mode gradients of single stress components nested inside the reverse-mode gradient of
the loss, one material point at a time under ``vmap``, interpolant and hyper-network evaluated inside,
neural ODEs by matrix products and without rematerialisation.
Ours are the pointwise strong form with exact derivatives (``autodiff`` in the configuration) and with central
differences over the measured grid (``strong``), and the equilibrated form. All see the same number of stress
evaluations: points times load steps.

Usage: python benchmarks/training_step.py [--points 250] [--repeats 20]
"""

import argparse
import json
import os
import time
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

os.environ.setdefault("JAX_PLATFORMS", "cpu")
os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:1])

import jax

jax.config.update("jax_enable_x64", True)

import jax.numpy as jnp
import numpy as np
from flax import nnx

from hypernode.config.methods import Frequencies
from hypernode.fem.equilibrium_gap import EquilibriumGap
from hypernode.fem.mesh import rectilinear
from hypernode.material.laws import node_stress
from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.kinematics import Invariants, invariants
from hypernode.mechanics.stress import first_piola_kirchhoff
from hypernode.networks.neural_ode import layer_sizes
from hypernode.networks.terms import INVARIANTS, TERMS
from hypernode.networks.weights import make_network, split_trainable
from hypernode.training.losses import divergence, mesh_gather

PAPER_TERMS = ("I1", "I2", "I1_I4v", "I1_I4w", "I4v_I4w")
STEPS = 4
RK4_STEPS = 4


def networks(dtype):
    """Interpolant and hyper-network of the paper's P example in one precision."""
    node = NodeMaterial(terms=PAPER_TERMS, hidden=(4, 4), steps=RK4_STEPS, invariant_scale=0.4, stress_scale=1.0)
    hyper = make_network(Frequencies(features=40, frequency_scale=1.0, widths=[40, 40]), 0, node.size, 0)
    hyper.layers[-1].bias[...] = node.initial_params(jax.random.key(0)).astype(jnp.float32)
    hyper.layers[-1].kernel[...] = 0.01 * hyper.layers[-1].kernel[...]
    inter = make_network(Frequencies(features=100, frequency_scale=1.0, widths=[40, 40]), 1, 4, 1)
    result = []
    for network in (hyper, inter):
        graph, state = nnx.split(network)
        # The frequencies as well, which are no parameters: one of them in double precision makes all that follows so.
        result += split_trainable(nnx.merge(graph, jax.tree.map(lambda a: a.astype(dtype), state)))
    return node, *result


def pointwise_derivatives(node, I, node_params):
    """dPsi/dI of one material point with matrix products, as per-point code writes it."""
    weights, mixture, constants, _ = node.split(node_params)
    alpha = jax.nn.sigmoid(mixture)
    shifted = {name: getattr(I, name) - value for name, value in INVARIANTS.items()}

    def slope(h, matrices):
        v = h[None]
        for matrix in matrices[:-1]:
            v = jnp.tanh(matrix @ v)
        return (matrices[-1] @ v)[0]

    shapes = [(b, a) for a, b in pairwise(layer_sizes(node.hidden))]
    ends = np.cumsum([a * b for a, b in shapes])[:-1]
    total = {name: jnp.zeros(()) for name in INVARIANTS}
    for index, term in enumerate(node.terms):
        names = TERMS[term]
        a = alpha[node.mixtures.index(term)] if len(names) == 2 else 1.0
        shares = dict(zip(names, (a, 1.0 - a), strict=False))
        h = sum(share * shifted[name] for name, share in shares.items()) / node.invariant_scale
        h = jnp.maximum(h, 0.0) if "4" in term else h
        parts = jnp.split(weights[:, index], ends)
        matrices = [part.reshape(shape) for part, shape in zip(parts, shapes, strict=True)]
        dt = 1.0 / node.steps
        for _ in range(node.steps):
            k1 = slope(h, matrices)
            k2 = slope(h + 0.5 * dt * k1, matrices)
            k3 = slope(h + 0.5 * dt * k2, matrices)
            k4 = slope(h + dt * k3, matrices)
            h = h + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        for name, share in shares.items():
            total[name] = total[name] + NodeMaterial.share * share * h
    for name, constant in zip(node.constants, constants, strict=True):
        total[name] = total[name] + jnp.exp(constant)
    return Invariants(**total)


def published(X, t):
    """Gradient of the strong-form loss by nested reverse mode, float64."""
    node, hyper, apply_hyper, inter, apply_inter = networks(jnp.float64)

    def stress(params, x, tau, i, J):
        F = jnp.eye(2) + 0.1 * apply_inter(inter)(x, tau[None]).reshape(2, 2)
        node_params = apply_hyper(params)(x)
        angle = node.fibre_angle(node_params)
        dPsi = pointwise_derivatives(node, invariants(F, angle), node_params)
        return first_piola_kirchhoff(F, dPsi, angle)[i, J]

    def residual(params, x, tau):
        # (Div P)_i = dP_iX/dX + dP_iY/dY: one reverse-mode gradient for each component of P.
        d = {(i, J): jax.grad(stress, 1)(params, x, tau, i, J) for i in range(2) for J in range(2)}
        return (d[0, 0][0] + d[0, 1][1]) ** 2 + (d[1, 0][0] + d[1, 1][1]) ** 2

    def loss(params):
        return jnp.mean(jax.vmap(lambda tau: jax.vmap(lambda x: residual(params, x, tau))(X))(t))

    return jax.jit(jax.value_and_grad(loss)), hyper


def ours_exact(X, t):
    """Gradient of the same loss with the pipeline's divergence, float32, tabulated F and dF."""
    node, hyper, apply_hyper, inter, apply_inter = networks(jnp.float32)
    X, t = X.astype(jnp.float32), t.astype(jnp.float32)

    def gradient(X):
        H = apply_inter(inter)(X[None], t[:, None, None]).reshape(len(t), -1, 2, 2)
        return jnp.moveaxis(jnp.eye(2, dtype=jnp.float32) + 0.1 * H, (2, 3), (0, 1))

    unit = jnp.eye(2, dtype=jnp.float32)
    F = gradient(X)
    dF = jnp.stack([jax.jvp(gradient, (X,), (jnp.broadcast_to(unit[k], X.shape),))[1] for k in range(2)])
    problem = SimpleNamespace(node=node, length=1.0)

    def loss(params):
        found, _ = divergence(problem, apply_hyper(params), X, F, dF)
        return jnp.mean(jnp.sum(found**2, axis=0))

    return jax.jit(jax.value_and_grad(loss)), hyper


def on_a_grid(X, t, penalty):
    """Gradient of a penalty of the stress at the centres of a grid with as many cells as there are points."""
    node, hyper, apply_hyper, inter, apply_inter = networks(jnp.float32)
    n = next(n for n in range(int(np.sqrt(len(X))), 0, -1) if len(X) % n == 0)
    mesh = rectilinear(np.linspace(0, 1, n + 1), np.linspace(0, 1, len(X) // n + 1))
    X, t = jnp.asarray(mesh.centres, jnp.float32), t.astype(jnp.float32)
    H = apply_inter(inter)(X[None], t[:, None, None]).reshape(len(t), -1, 2, 2)
    F = jnp.moveaxis(jnp.eye(2, dtype=jnp.float32) + 0.1 * H, (2, 3), (0, 1))
    of_stress = penalty(mesh, len(t))

    def loss(params):
        return of_stress(node_stress(node, F, apply_hyper(params)(X).T))

    return jax.jit(jax.value_and_grad(loss)), hyper


def ours_differences(X, t):
    """The same pointwise loss with the divergence by central differences over the measured grid."""

    def penalty(mesh, steps):
        interior = np.flatnonzero(np.bincount(mesh.cells.ravel(), minlength=len(mesh.nodes)) == 4)
        gather = mesh_gather(mesh, interior)
        area = float(mesh.areas.mean())
        return lambda P: sum(jnp.mean((gather(P[i]) / area) ** 2) for i in range(2))

    return on_a_grid(X, t, penalty)


def ours_equilibrated(X, t):
    """The distance from the nearest equilibrated stress, the pipeline's own."""

    def penalty(mesh, steps):
        held = np.array([[1, 0], [1, 0], [0, 1], [0, 1]], dtype=bool)
        gap = EquilibriumGap.build(mesh, held, held)
        resultant, scale = jnp.ones((steps, 2), jnp.float32), jnp.ones(steps, jnp.float32)
        return lambda P: jnp.sum(gap.squared(P, resultant, scale))

    return on_a_grid(X, t, penalty)


def main():
    """Print and store the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, default=250)
    parser.add_argument("--repeats", type=int, default=20)
    given = parser.parse_args()
    X = jax.random.uniform(jax.random.key(1), (given.points, 2))
    t = jnp.linspace(0.25, 1.0, STEPS)
    candidates = {}
    for build in (published, ours_exact, ours_differences, ours_equilibrated):
        step, params = build(X, t)
        start = time.perf_counter()
        jax.block_until_ready(step(params))
        candidates[build.__name__] = (step, params, time.perf_counter() - start)
    times = {name: [] for name in candidates}
    for _ in range(given.repeats):
        for name, (step, params, _) in candidates.items():
            start = time.perf_counter()
            jax.block_until_ready(step(params))
            times[name].append(time.perf_counter() - start)
    base = np.array(times["published"])
    rows = {
        name: {
            "evaluations": given.points * STEPS,
            "median_s": float(np.median(values)),
            "compile_s": candidates[name][2],
            "times_faster": float(np.median(base / np.array(values))),
        }
        for name, values in times.items()
    }
    for name, row in rows.items():
        numbers = f"{row['median_s'] * 1e3:9.2f} ms  compile {row['compile_s']:6.1f} s  x {row['times_faster']:.1f}"
        print(f"{name:20s} {numbers}")
    out = Path("results/benchmarks/training_step.json")
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
