"""Whether a hyper-network is polished, and whether what comes of it is kept."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from hypernode.config.methods import Constrained, Polish
from hypernode.identification import thresholds
from hypernode.identification.problem import FieldProblem
from hypernode.polishing.descent import Descent, descend_weights
from hypernode.polishing.held_out import Misfit, held_out_steps, why_not_better
from hypernode.polishing.objective import weight_objective
from hypernode.polishing.weight_field import WeightField
from hypernode.progress import say
from hypernode.verdict import Ending


@dataclass(frozen=True, kw_only=True)
class Polished:
    """A hyper-network after its polishing.

    Attributes:
        weights: those that are kept, of the network before or of the polished one.
        u: displacement in equilibrium with them (step, node, 2); None where there is none.
        kept: whether they are the polished ones.
        reason: why, in a sentence.
        held_out: load steps that the polishing did not see.
        misfits: {"used", "held_out"} -> {"before", "after"} -> {"displacement", "force"} -> root mean square over their
            uncertainty; "after" only where there was a descent, nothing where there is no equilibrium before.
        history: displacement misfit of the steps used after every step of the descent; one number without a descent.
        ending: how the descent ended; None where there was none.
    """

    weights: Float[np.ndarray, " weight"]
    u: Float[np.ndarray, "step node 2"] | None
    kept: bool
    reason: str
    held_out: Bool[np.ndarray, " step"]
    misfits: dict
    history: Float[np.ndarray, " record"]
    ending: Ending | None


@dataclass(frozen=True, kw_only=True)
class _Part:
    """Some load steps of a test and how the network before explains them."""

    problem: FieldProblem
    steps: Int[np.ndarray, " kept"]
    states: list
    linear: object
    before: Misfit

    @classmethod
    def of(cls, problem: FieldProblem, steps, params, states) -> "_Part":
        part, states = problem.of_steps(steps), [states[step] for step in steps]
        linear = part.linearise(params, states, problem.sigma)
        return cls(problem=part, steps=steps, states=states, linear=linear, before=Misfit.of(part, states, linear))

    def after(self, states) -> Misfit:
        return Misfit.of(self.problem, [states[step] for step in self.steps], self.linear)


def polish(
    problem: FieldProblem, field: WeightField, constrained: Constrained, settings: Polish, guesses, name: str
) -> Polished:
    """Polish a network on some load steps of its test, and keep it if it explains the others better.

    The network before has learnt the field of all load steps, the held-out ones included; the polished one sees them
    only by what is left of that. The comparison is hard on the polished network, and what it wins is its own.

    Args:
        problem: all load steps of the test, with the law of the network.
        field: of the network before.
        constrained, settings: the method's sections ``constrained`` and ``polish``.
        guesses: displacement of every step that equilibrium is near to.
        name: case, for progress.
    """
    start, held = field.start, held_out_steps(problem.observations.loading.load_case)
    params = field.params(start)
    states = problem.equilibrium.states(params, guesses)
    if states is None:
        return Polished(
            weights=start,
            u=None,
            kept=False,
            reason="the network before has no equilibrium",
            held_out=held,
            misfits={},
            history=np.array([np.nan]),
            ending=None,
        )
    used = _Part.of(problem, np.flatnonzero(~held), params, states)
    other = _Part.of(problem, np.flatnonzero(held), params, states) if held.any() else None
    misfits = {"used": {"before": used.before.sizes}}
    if other is not None:
        misfits["held_out"] = {"before": other.before.sizes}

    def left(reason):
        say("polishing", name, f"left as it is: {reason}")
        u, history = np.stack([state.u for state in states]), np.array([used.before.sizes["displacement"]])
        return Polished(
            weights=start, u=u, kept=False, reason=reason, held_out=held, misfits=misfits, history=history, ending=None
        )

    if other is None:
        return left("no test has two load steps, so that none can be held out")
    if used.before.explained and other.before.explained:
        return left("displacements and forces are explained to their noise")
    if settings.iterations == 0:
        return left("it is only judged")
    objective = weight_objective(used.problem, field, constrained, settings)
    found = descend_weights(objective, used.states, settings, name)
    return _kept(problem, field, found, states, (used, other), misfits, name)


def _kept(problem: FieldProblem, field: WeightField, found: Descent, states, parts, misfits: dict, name: str):
    """The polished network as it is stored, or the one before."""
    (used, other), weights = parts, field.stored(found.weights)
    held = np.zeros(len(states), bool)
    held[other.steps] = True
    reached = problem.equilibrium.states(field.params(weights), [state.u for state in states])
    reason = "the polished network has no equilibrium in a load step that was held out"
    if reached is not None:
        after = used.after(reached), other.after(reached)
        for key, each in zip(misfits, after, strict=True):
            misfits[key]["after"] = each.sizes
        reason = unexplained(after[0]) or why_not_better(other.before, after[1])
    kept = not reason
    if kept:
        reason, states = "held-out displacements and forces are explained better", reached
    say("polishing", name, f"{'kept' if kept else 'not kept'}, {found.ending}: {reason}")
    u = np.stack([state.u for state in states])
    return Polished(
        weights=weights if kept else field.start,
        u=u,
        kept=kept,
        reason=reason,
        held_out=held,
        misfits=misfits,
        history=found.history,
        ending=found.ending,
    )


def unexplained(used: Misfit) -> str:
    """Why a polished network does not explain what it was polished on; empty where it does.

    What no law of the networks follows, a fit distributes: stress is then wrong where forces were right.
    """
    limits = {"displacement": thresholds.UNEXPLAINED, "force": thresholds.FORCES_UNEXPLAINED}
    for name, size in used.sizes.items():
        if size > limits[name]:
            return (
                f"{name}s that it was polished on are missed by {size:.3g} of their noise, more than {limits[name]:g}: "
                "the networks do not contain this law"
            )
    return ""
