"""The answer of a search for materials and lines: all load steps, with the noise and the window that are left."""

import dataclasses

import numpy as np
import scipy.sparse

from hypernode.data.believed_noise import BelievedNoise
from hypernode.data.believed_window import BelievedWindow
from hypernode.identification.candidate import Candidate
from hypernode.identification.equilibrium import State
from hypernode.identification.interface_estimate import InterfaceEstimate
from hypernode.identification.interface_fit import HELD, InterfaceFit
from hypernode.identification.interfaces import Lines
from hypernode.identification.objective import Objective
from hypernode.identification.regulariser import JumpCost
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.trials import Trials
from hypernode.trace import Trial

#: Steps of the last descents, which begin where the search ended.
STEPS = 4
#: Correlation of what different steps leave, up to which it is noise: a shared reference picture makes a half.
NOISE_SHARED = 0.6
#: Ratio of what is left to the believed noise beyond which that is told anew.
NOISE_KNOWN = 1.1


def answer(trials: Trials, kept: Candidate, finds_window: bool) -> InterfaceEstimate:
    """The estimate of a candidate for all load steps.

    What is left differs from step to step, and is noise; or it is the same in all, and is what the description misses,
    up to what finite elements are trusted with.

    Args:
        kept: the candidate that the search ended with.
        finds_window: whether the side of the window is sought.
    """
    every = list(range(len(kept.problem.observations.u)))
    finds = finds_window and kept.fit.field.count > 1
    move, field, window = "all load steps", kept.fit.field, kept.fit.window
    final = trials.descend(move, kept, kept.problem, field, kept.u, every, STEPS, window, finds) or kept
    floor = _believed(trials, final, finds)
    problem = trials.problem(final.terms, final.subcells, floor)
    descent = InterfaceFit(SeenTest(problem, every), settled=True)
    field = final.fit.field.on(Lines.of(problem.observations.grid, problem.refinement))
    fit = descent.descend(field, [final.u[k] for k in every], STEPS)
    found = Candidate("the answer", final, problem, final.fit if fit is None else fit, final.u)
    return _estimate(trials, found, descent)


def _believed(trials: Trials, final: Candidate, finds_window: bool) -> float:
    """What finite elements miss, once the trials believe the noise and the window that are left."""
    left, observations, sigma = final.fit.left, final.problem.observations, final.problem.sigma
    floor = 0.0
    if final.level > NOISE_KNOWN and left.steps <= NOISE_SHARED:
        believed = BelievedNoise.read(trials.measurement.attrs)
        trials.believe(dataclasses.replace(believed, factor=believed.factor * final.level).of(trials.measurement))
    elif final.level > NOISE_KNOWN:
        trusted = trials.strategy.description_error(False, final.subcells, len(observations.grid.cells))
        beside = sigma * float(np.sqrt(left.level**2 - observations.scatter**2))
        floor = min(beside, trusted * float(np.abs(observations.u).max()))
    if finds_window and final.fit.window > 0.0:
        step = SeenTest(final.problem, []).step
        window = BelievedWindow(final.fit.window * step, final.fit.window_error * step)
        trials.believe(window.of(trials.measurement))
    return floor


def _estimate(trials: Trials, found: Candidate, descent: InterfaceFit) -> InterfaceEstimate:
    fit, problem, test = found.fit, found.problem, descent.test
    near, materials = descent.near(fit.field), fit.field.materials
    count = len(fit.field.numbers(near))
    going = np.ones(count, bool)
    going[: materials.size] = (materials > problem.basis.lowest).ravel()
    each = zip(fit.states, problem.observations.boundaries, strict=True)
    trace, records = trials.trace(fit.left.independent)
    misfits = {"displacement": fit.misfit / problem.observations.scatter, "force": fit.forces}
    score = found.score(fit.left.independent)
    start = records[found.start]
    trial = Trial(found.move, start, found.terms, fit.field.count, misfits, score, str(fit.ending))
    return InterfaceEstimate(
        Objective(problem, None, 0.0, JumpCost(), np.zeros(count), np.zeros(count), trials.strategy),
        test.jacobian(fit.field, fit.states, near),
        materials,
        [State(u, force, boundary.free) for (u, force, _), boundary in each],
        np.array([*fit.history, fit.misfit]),
        fit.cost,
        fit.ending,
        None,
        trial=trial,
        trace=trace.with_trial(trial),
        field=fit.field,
        near=near,
        going=going,
        # Where neither data nor bends say anything of a distance, it is known to some cells.
        held=descent.held(fit.field, near) + scipy.sparse.diags(np.where(np.arange(count) < materials.size, 0.0, HELD)),
        left=fit.left,
        scored=score,
    )
