"""Equilibrium as a constraint: the material field whose finite-element solution is what was measured.

Displacements are data here, not input. The unknown is a field of convex-basis coefficients, one set a
cell; for every guess JAX-FEM solves the equilibrium of each load step, and the misfit of displacements
and edge forces, in units of their noise, is reduced together with the jumps of the field by
Gauss-Newton steps. Nothing measured is ever differentiated, so noise hardly matters.

The stiffness alone comes first: one number a cell finds where the material changes, along a path without the
valleys that all coefficients together make. From there the other terms are released. Where noise makes
many minima, what was found is shaken out of its own to see whether there is a better one. Where interfaces lie
anywhere and noise does not hide them, cells are then divided.
"""

import dataclasses
import functools
import sys

import numpy as np

from hypernode.config.methods import Constrained
from hypernode.identification.gauss_newton import (
    CHANCE,
    CLOSE,
    MUCH_LEFT,
    UNEXPLAINED,
    Found,
    Plateau,
    descend,
    described,
)
from hypernode.identification.problem import FieldProblem
from hypernode.mechanics.convex_basis import FIBRE_VECTOR

#: Share of the cost below which misfits leave nothing to explain: without noise, that of a neo-Hookean sheet is a few
#: thousandths, and that of any other nearly one.
NOTHING_LEFT = 0.02


#: The term that joins once further ones are known: with all at once the valleys are longest.
LAST = "stiffening"


#: What jumps cost for a few iterations, to leave one of the many minima that noise makes: factors of the weight and of
#: the size above which jumps stop costing more, and how many iterations.
SHAKES = ((0.2, 1.0, 6), (1.0, 10.0, 4))


#: Into how many rows and columns of parts cells are divided; how many parts a sheet may have, for memory; and for how
#: many iterations it pays.
PARTS, MOST_PARTS, PARTS_ITERATIONS = 2, 16000, 12


#: Before more terms follow, the stiffness is good enough there, or once its cost has fallen by less than
#: ``PLAIN_TOLERANCE`` in one iteration.
PLAIN_PLATEAUS, PLAIN_TOLERANCE = (Plateau(0.2, 3),), 3e-3


#: Where further terms may follow, a test that is not explained waits for them there, or where it is stuck.
FURTHER_PLATEAUS = Plateau(0.1, 5, above=UNEXPLAINED), Plateau(0.02, 5, above=CLOSE, left=MUCH_LEFT)


def identify(measurement, settings: Constrained, name: str) -> Found:
    """The material field that explains a measurement: the stiffness alone, then the terms of the basis.

    None follows where the stiffness leaves nothing to explain, as it does without noise where a sheet is neo-Hookean.
    Where the terms leave doubt, all at once are released from the homogeneous sheet, since a stiffness that had to
    stand for other terms may mislead; where no field of theirs explains the test, the further terms as well, which
    would only make longer valleys where they are not needed. Of what was tried the most probable field is kept, and
    shaken or divided.

    Raises:
        IdentificationError: no equilibrium at the homogeneous start.
    """

    @functools.cache
    def problem_of(*terms):
        return FieldProblem(measurement, settings.model_copy(update={"terms": list(terms)}))

    def with_terms(terms, before, plateaus, tolerance=settings.tolerance):
        reached = descend(problem_of(*terms), settings, name, before, plateaus, tolerance)
        path = [] if before is None else [before.history]
        return dataclasses.replace(reached, history=np.concatenate([*path, reached.history]))

    likeliest = functools.partial(min, key=lambda each: each.cost)

    # Whether the sheet is compressible is no term among others: it says what the stiffness means.
    first = [term for term in settings.terms if term == "J"]
    further = FURTHER_PLATEAUS if settings.further_terms else ()
    if settings.terms == first:
        plain = with_terms(first, None, further)
        tried = [plain]
    else:
        plain = with_terms(first, None, PLAIN_PLATEAUS, PLAIN_TOLERANCE)
        tried = [plain]
        if plain.data_share >= NOTHING_LEFT:
            tried = [with_terms(settings.terms, plain, further)]
            if tried[0].ambiguous:
                tried.append(with_terms(settings.terms, None, further))
    found = likeliest(tried)
    terms = [*settings.terms, *settings.further_terms]
    if settings.further_terms and found.underfitted:
        soon = [term for term in terms if term != LAST]
        tried = [found, with_terms(soon, plain, further if LAST in terms else ())]
        if LAST in terms:
            tried.append(with_terms(terms, tried[-1], ()))
        found = likeliest(tried)
    found = without_fibres(found, settings, name)
    found = without_outliers(found, settings, name)
    found = perturbed(found, settings, name)
    found = subdivided(found, measurement, settings, name)
    if found.history[-1] > UNEXPLAINED:
        print(
            f"warning: constrained field of {name}: displacements are missed by {found.history[-1]:.1f} times their "
            f"noise. The terms ({described(found.problem)}) do not explain this test, or "
            "the descent ended early: trust no number of this field; add further_terms or iterations",
            file=sys.stderr,
        )
    return found


def _nearly(found: Found, params, settings: Constrained, name: str) -> Found:
    """The more probable of ``found`` and where a descent from ``params`` ends.

    It is tried if these cost hardly more than ``found`` does: no more than noise changes costs by chance.
    """
    problem = found.problem
    other = found.at(params)
    if other is None or other.cost - found.cost > CHANCE * np.sqrt(problem.cost_of_noise):
        return found
    reached = descend(problem, settings, name, other, (), settings.tolerance)
    history = np.concatenate([found.history, reached.history])
    return min(found, dataclasses.replace(reached, history=history), key=lambda each: each.cost)


def without_fibres(found: Found, settings: Constrained, name: str) -> Found:
    """Where a descent without fibres ends, if a noisy test does not tell of them and that field is the more probable.

    A descent begins with weak fibres, which noise may strengthen where they hardly carry anything; only under other
    loads would they.
    """
    fibre = [k for k, key in enumerate(found.problem.basis.names) if key in FIBRE_VECTOR]
    if not found.problem.sharp or not found.params[:, fibre].any():
        return found
    params = found.params.copy()
    params[:, fibre] = 0.0
    return _nearly(found, params, settings, name)


def without_outliers(found: Found, settings: Constrained, name: str) -> Found:
    """Where descents end that begin at the median of each cell's neighbours, as long as they find something better.

    Cells of which the test says little stay where an early iteration left them, and under other deformations they are
    what is most wrong. Not where it says so much of each that the medians do not explain it, as it does without noise,
    nor through a correlation window, where cells in between are something else.
    """
    while found.problem.sharp:
        better = _nearly(found, found.problem.mesh.median_of_neighbours(found.params), settings, name)
        if found.cost - better.cost < settings.tolerance * found.problem.cost_of_noise:
            return better
        found = better
    return found


def perturbed(found: Found, settings: Constrained, name: str) -> Found:
    """The best of what descents lead to that begin at ``found`` after jumps have cost something else for a while.

    Only where noise makes minima, and not through a correlation window, where what is gained is not worth the time.
    """
    if not found.problem.sharp:
        return found
    for weight, scale, iterations in SHAKES:
        other = {
            "regulariser_weight": weight * settings.regulariser_weight,
            "jump_scale": scale * settings.jump_scale,
            "iterations": min(iterations, settings.iterations),
        }
        away = descend(found.problem, settings.model_copy(update=other), name, found, (), 0.0)
        back = descend(found.problem, settings, name, away, (), settings.tolerance)
        history = np.concatenate([found.history, away.history, back.history])
        found = min(found, dataclasses.replace(back, history=history), key=lambda each: each.cost)
    return found


def subdivided(found: Found, measurement, settings: Constrained, name: str) -> Found:
    """The field with cells divided into parts, where interfaces lie anywhere and the data can tell where.

    A cell that an interface cuts is no material: neither does it deform as a mixture would, nor is it one. Parts
    of it are both more nearly, and what is left of the misfit tells how much of the cell is which.
    """
    parts = PARTS**2 * len(found.params)
    if not found.problem.blurred or found.unexplained > 1.0 or parts > MOST_PARTS:
        return found
    terms, iterations = list(found.problem.basis.terms), min(PARTS_ITERATIONS, settings.iterations)
    settings = settings.model_copy(update={"terms": terms, "iterations": iterations})
    finer = descend(FieldProblem(measurement, settings, PARTS), settings, name, found, (), settings.tolerance)
    return dataclasses.replace(finer, history=np.concatenate([found.history, finer.history]))
