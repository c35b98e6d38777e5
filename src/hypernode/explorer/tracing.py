"""The law of a material as text: traced by JAX at one point, and written out scalar by scalar.

The page that asks a material for its stress has no mechanics of its own: what it evaluates is what
:meth:`~hypernode.material.field.Material.stress` computes, operation by operation.
"""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from hypernode.explorer.errors import ExplorerError
from hypernode.explorer.formulas import FUNCTIONS, TEXT, Formulas

#: Primitives that move numbers about: done by JAX itself, with the numbers of the formulas in their place.
_MOVES = {
    *("broadcast_in_dim", "concatenate", "copy", "expand_dims", "reshape", "rev", "slice", "split", "squeeze"),
    *("stack", "transpose"),
}
#: Primitives that are another function, and the parameter in which it stands.
_CALLS = {"jit": "jaxpr", "remat2": "jaxpr", "checkpoint": "jaxpr", "custom_jvp_call": "call_jaxpr"}
#: Primitive -> operation, where they have another name.
_SAME = {"add_any": "add"} | {name: name for name in (*TEXT, *FUNCTIONS) if name != "where"}


@dataclass(frozen=True)
class TracedLaw:
    """A law as text.

    Attributes:
        lines: statements, of inputs ``F[0..3]`` (F_xX, F_xY, F_yX, F_yY) and ``p[0..]``, the parameters in their order.
        results: text of P_xX, P_xY, P_yX and P_yY.
    """

    lines: tuple[str, ...]
    results: tuple[str, ...]

    @property
    def javascript(self) -> str:
        """A function (F, p) -> P."""
        declared = ",\n".join(self.lines)
        return f"(F,p)=>{{let {declared};\nreturn[{','.join(self.results)}]}}"


def trace(stress, params) -> TracedLaw:
    """The text of a law.

    Args:
        stress: P[i, J, point] of (F[i, J, point], params).
        params: for one point, that of any: a tree of arrays whose last axis has one entry.

    Raises:
        ExplorerError: the law does something that has no text here.
    """
    leaves, tree = jax.tree.flatten(params)
    closed = jax.make_jaxpr(lambda F, *leaves: stress(F, tree.unflatten(leaves)))(jnp.eye(2)[..., None], *leaves)
    formulas, first = Formulas(), 0
    inputs = [np.array([formulas.input(f"F[{k}]") for k in range(4)]).reshape(2, 2, 1)]
    for leaf in leaves:
        names = [formulas.input(f"p[{first + k}]") for k in range(leaf.size)]
        inputs.append(np.array(names, dtype=int).reshape(leaf.shape))
        first += leaf.size
    (P,) = _Interpreter(formulas).run(closed.jaxpr, closed.consts, inputs)
    lines, results = formulas.statements(P.ravel().tolist())
    return TracedLaw(tuple(lines), tuple(results))


class _Interpreter:
    """Evaluates a jaxpr on arrays of numbers of formulas."""

    def __init__(self, formulas: Formulas):
        self.formulas = formulas

    def run(self, jaxpr, consts, arguments) -> list[np.ndarray]:
        """What a jaxpr returns for arguments that are arrays of formulas; its constants are numbers."""
        known = dict(zip(jaxpr.invars, arguments, strict=True))
        known |= {variable: self._numbers(value) for variable, value in zip(jaxpr.constvars, consts, strict=True)}

        def value(atom):
            return self._numbers(atom.val) if hasattr(atom, "val") else known[atom]

        for equation in jaxpr.eqns:
            found = self._equation(equation, [value(atom) for atom in equation.invars])
            known |= zip(equation.outvars, found, strict=True)
        return [value(atom) for atom in jaxpr.outvars]

    def _numbers(self, value) -> np.ndarray:
        value = np.asarray(value)
        return np.array([self.formulas.number(each) for each in value.ravel()], dtype=int).reshape(value.shape)

    def _equation(self, equation, arguments) -> list[np.ndarray]:
        name, params = equation.primitive.name, equation.params
        if name in _MOVES:
            moved = equation.primitive.bind(*(jnp.asarray(each, jnp.int32) for each in arguments), **params)
            return [np.asarray(each) for each in (moved if equation.primitive.multiple_results else [moved])]
        if name in _CALLS:
            inner = params[_CALLS[name]]
            return self.run(getattr(inner, "jaxpr", inner), getattr(inner, "consts", ()), arguments)
        if name == "scan":
            return self._scan(params, arguments)
        if name == "reduce_sum":
            return [self._sum(arguments[0], params["axes"])]
        return [self._elementwise(name, params, arguments)]

    def _scan(self, params, arguments) -> list[np.ndarray]:
        """A loop without inputs or outputs of single steps, one step after the other."""
        consts, carry = params["num_consts"], params["num_carry"]
        body, state = params["jaxpr"], arguments[consts:]
        if len(state) != carry or len(body.out_avals) != carry:
            raise ExplorerError("the law of this material loops over arrays, which the explorer cannot write out")
        for _ in range(params["length"]):
            state = self.run(body.jaxpr, body.consts, [*arguments[:consts], *state])
        return state

    def _sum(self, argument, axes) -> np.ndarray:
        kept = [axis for axis in range(argument.ndim) if axis not in axes]
        ordered = argument.transpose(*kept, *axes)
        ordered = ordered.reshape(*(argument.shape[axis] for axis in kept), -1)
        total = ordered[..., 0]
        for k in range(1, ordered.shape[-1]):
            total = self._each("add", total, ordered[..., k])
        return total

    def _elementwise(self, name: str, params, arguments) -> np.ndarray:
        if name == "convert_element_type" and not np.issubdtype(params["new_dtype"], np.integer):
            return arguments[0]
        if name == "integer_pow":
            return self._power(arguments[0], params["y"])
        if name == "square":
            return self._power(arguments[0], 2)
        if name == "logistic":
            exponential = self._each("exp", self._each("neg", arguments[0]))
            return self._each("div", self._numbers(1.0), self._each("add", self._numbers(1.0), exponential))
        if name == "select_n" and len(arguments) == 3:
            return self._each("where", arguments[0], arguments[2], arguments[1])
        if name not in _SAME:
            raise ExplorerError(f"the law of this material uses '{name}', which the explorer cannot write out yet")
        return self._each(_SAME[name], *arguments)

    def _power(self, base, exponent: int) -> np.ndarray:
        power = base
        for _ in range(abs(exponent) - 1):
            power = self._each("mul", power, base)
        return power if exponent > 0 else self._each("div", self._numbers(1.0), power)

    def _each(self, operation: str, *arguments) -> np.ndarray:
        """An operation on every element of arrays of one shape, or of none."""
        together = np.broadcast_arrays(*arguments)
        found = [self.formulas.apply(operation, *map(int, each)) for each in zip(*map(np.ravel, together), strict=True)]
        return np.array(found, dtype=int).reshape(together[0].shape)
