"""Increasing functions of h [n], zero at zero, with weights [k, n] from outside."""

from itertools import pairwise

import numpy as np


def flow(h, weights, hidden, steps, largest_slope=1.5):
    """h(1) of dh/dtau = f(h), h(0) = h, by equal steps of RK4; f is a tanh network without biases.

    f is scaled down where its slope over one step might exceed ``largest_slope``: the discrete flow is increasing too.
    """
    at, matrices = 0, []
    for before, after in pairwise((1, *hidden, 1)):
        matrices.append(weights[at : at + before * after].reshape(after, before, -1))
        at += before * after
    bound = np.ones((1, weights.shape[1]))
    for matrix in matrices:
        bound = np.einsum("bap,ap->bp", np.abs(matrix), bound)
    matrices[-1] = matrices[-1] / np.maximum(1.0, bound[0] / steps / largest_slope)

    def f(h):
        layer = h[None]
        for depth, matrix in enumerate(matrices):
            layer = np.einsum("bap,ap->bp", matrix, layer)
            layer = np.tanh(layer) if depth < len(matrices) - 1 else layer
        return layer[0]

    dt = 1.0 / steps
    for _ in range(steps):
        k1 = f(h)
        k2 = f(h + 0.5 * dt * k1)
        k3 = f(h + 0.5 * dt * k2)
        h = h + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + f(h + dt * k3))
    return h


def softplus(x):
    """ln(1 + exp(x)), also of complex numbers."""
    size = np.where(np.real(x) > 0.0, x, -x)
    return np.where(np.real(x) > 0.0, x, 0.0) + np.log1p(np.exp(-size))


def convex_slope(h, weights, hidden, steps):
    """Derivative of an input-convex network at h, less the one at 0."""

    def slope(h):
        weight, values = iter(weights), []
        for width in hidden:
            totals = [(next(weight), next(weight)) for _ in range(width)]
            layer = []
            for on_h, bias in totals:
                positive = [softplus(next(weight)) for _ in values]
                argument = on_h * h + bias + sum(w * value for w, (value, _) in zip(positive, values, strict=True))
                inner = on_h + sum(w * derivative for w, (_, derivative) in zip(positive, values, strict=True))
                layer.append((softplus(argument), inner / (1.0 + np.exp(-argument))))
            values = layer
        return sum(softplus(next(weight)) * derivative for _, derivative in values)

    return slope(h) - slope(0.0 * h)


def exponential(x, largest=8.0):
    """exp(x) - 1, continued by a straight line beyond ``largest``."""
    beyond = np.real(x) > largest
    return np.exp(np.where(beyond, largest, x)) * (1.0 + np.where(beyond, x - largest, 0.0)) - 1.0


def constitutive_slope(h, weights, hidden, steps):
    """Derivative of a sum of h^2, exp(a h) and exp(b h^2) with positive factors, less its value at 0."""
    square, plain, rate, bell, width = softplus(weights[:5])
    return square * h + plain * exponential(rate * h) + bell * h * (1.0 + exponential(width * h**2))


POTENTIALS = {"node": flow, "icnn": convex_slope, "cann": constitutive_slope}
