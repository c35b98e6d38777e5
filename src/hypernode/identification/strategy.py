"""Equilibrium as a constraint: the material field whose finite-element solution is what was measured.

Displacements are data here, not input. The unknown is a field of convex-basis coefficients, one set a
cell; for every guess JAX-FEM solves the equilibrium of each load step, and the misfit of displacements
and edge forces, in units of their noise, is reduced together with the jumps of the field by
Gauss-Newton steps. Nothing measured is ever differentiated, so noise hardly matters.

The stiffness alone comes first: one number a cell finds where the material changes, along a path without the
valleys that all coefficients together make. From there the other terms are released. Where noise makes
many minima, what was found is perturbed out of its own to see whether there is a better one. Where interfaces lie
anywhere and noise does not hide them, cells are then divided.
"""

import functools
import sys
from dataclasses import replace

import numpy as np

from hypernode.config.methods import Constrained
from hypernode.data.measurement import with_independent_errors
from hypernode.identification.estimate import Estimate
from hypernode.identification.force_course import check_forces
from hypernode.identification.gauss_newton import descend, described
from hypernode.identification.problem import field_problem
from hypernode.identification.settings import STRATEGY, Strategy
from hypernode.mechanics.convex_basis import FIBRE_VECTOR
from hypernode.progress import say
from hypernode.verdict import Ending


def likeliest(*tried: Estimate) -> Estimate:
    """The most probable of some estimates; the first of several alike.

    One that does not explain the test, or explains its noise as well, is kept only where there is no other.
    """
    return min(tried, key=lambda each: (each.unexplained > 1.0 or each.overfitted, each.information_criterion))


def identify(measurement, settings: Constrained, name: str, strategy: Strategy = STRATEGY) -> Estimate:
    """The material field that explains a measurement, or comes nearest to it; see :func:`_identified`.

    Where not even errors that points or steps seem to share explain what a field leaves, they are no errors but
    deformation: then each counts as an independent one. Where noise does not explain what may as well be the error of
    finite elements, that error counts beside it.

    Args:
        measurement: an opened measurement.
        settings: configuration of the stage.
        name: case, for progress and messages.

    Raises:
        IdentificationError: no equilibrium at the homogeneous start.
    """
    found = _identified(measurement, settings, name, strategy)
    if found.problem.observations.scatter < 1.0 and found.unexplained > 1.0:
        misfit = found.misfits["displacement"]
        say("constrained", name, f"misfit {misfit:.2g}: what steps share is no noise; each error counts as its own")
        found = _identified(with_independent_errors(measurement), settings, name, strategy)
    if found.problem.observations.contested and found.unexplained > 1.0:
        say("constrained", name, "noise does not explain it; that interfaces cut cells is counted beside it")
        found = _identified(measurement, settings, name, replace(strategy, noise_rules=1.0))
    _warn(found, settings, name)
    return found


def _identified(measurement, settings: Constrained, name: str, strategy: Strategy) -> Estimate:
    """The stiffness alone, then the terms of the basis.

    None follows where the stiffness leaves nothing to explain, as it does without noise where a sheet is neo-Hookean.
    Fibres are there only if a field with them is the likelier one. Where the terms leave the test ambiguous, all at
    once are released from the homogeneous sheet, since a stiffness that had to stand for other terms may mislead;
    where they underfit it, the further terms as well, which would only make longer valleys where they are not needed.
    Of what was tried the most probable field is kept, and perturbed or divided.
    """

    @functools.cache
    def problem_of(*terms):
        return field_problem(measurement, settings.model_copy(update={"terms": list(terms)}), strategy=strategy)

    def with_terms(terms, before, plateaus, tolerance=settings.tolerance):
        reached = descend(problem_of(*terms), settings, name, before, plateaus, tolerance)
        return reached if before is None else reached.after(before)

    check_forces(problem_of, settings, name)
    # Whether the sheet is compressible is no term among others: it says what the stiffness means.
    first = [term for term in settings.terms if term == "J"]
    further = strategy.further_plateaus if settings.further_terms else ()
    if settings.terms == first:
        tried = [with_terms(first, None, further)]
        plain = tried[0]
    else:
        plain = with_terms(first, None, strategy.stiffness_plateaus, strategy.stiffness_tolerance)
        tried = [plain]
        if plain.data_share >= strategy.nothing_left:
            # Where the stiffness alone explains a noisy test, it stands for itself beside richer terms; not where
            # interfaces cut cells, which as mixtures are no such material.
            alone = plain.problem.noisy and plain.problem.observations.own_grid and not plain.ambiguous
            tried = [with_terms(first, plain, ())] if alone else []
            if settings.isotropic_terms and "fibre" in settings.terms:
                tried.append(with_terms(settings.isotropic_terms, plain, strategy.isotropic_plateaus))
            if not any(each.complete for each in tried):
                tried.insert(0, with_terms(settings.terms, plain, further))
            if likeliest(*tried).ambiguous:
                tried.append(with_terms(settings.terms, None, further))
    found = likeliest(*tried)
    if settings.further_terms and found.underfitted:
        terms, last = [*settings.terms, *settings.further_terms], strategy.last_term
        soon = [term for term in terms if term != last]
        tried = [found, with_terms(soon, plain, further if last in terms else ())]
        if last in terms:
            tried.append(with_terms(terms, tried[-1], ()))
        found = likeliest(*tried)
    found = without_fibres(found, settings, name)
    found = without_stray_cells(found, settings, name)
    found = perturbed(found, settings, name)
    return likeliest(*(subdivided(each, measurement, settings, name) for each in (found, *rivals(found, tried))))


def rivals(found: Estimate, tried: list[Estimate]) -> list[Estimate]:
    """Fields of other terms that explain a test as well, as far as what undivided cells miss of it allows to tell.

    Subcells miss less, and tell which terms are right.
    """
    if not found.problem.blurred:
        return []
    others = [each for each in tried if each.problem.basis.terms != found.problem.basis.terms]
    return [each for each in others if each.unexplained <= 1.0]


def _warn(found: Estimate, settings: Constrained, name: str) -> None:
    """Say on standard error what stands against believing a field."""
    misfit, strategy = found.misfits["displacement"], found.problem.strategy
    if misfit > strategy.unexplained:
        print(
            f"warning: constrained field of {name}: displacements are missed by {misfit:.1f} times their "
            f"noise. The terms ({described(found.problem)}) do not explain this test, or "
            "the descent ended early: trust no number of this field; add further_terms or iterations",
            file=sys.stderr,
        )
    if found.ending is not Ending.CONVERGED:
        print(
            f"warning: constrained field of {name}: not converged ({found.ending}): {found.summary}; "
            f"allow more iterations than {settings.iterations}, or doubt what depends on its last digits",
            file=sys.stderr,
        )


def _nearly(found: Estimate, params, settings: Constrained, name: str) -> Estimate:
    """The more probable of ``found`` and where a descent from ``params`` ends.

    It is tried if these cost hardly more than ``found`` does: no more than noise changes costs by chance.
    """
    problem = found.problem
    other = found.at(params)
    if other is None or other.cost - found.cost > problem.strategy.by_chance * np.sqrt(problem.cost_of_noise):
        return found
    reached = descend(problem, settings, name, other, (), settings.tolerance)
    return likeliest(found, reached.after(found))


def without_fibres(found: Estimate, settings: Constrained, name: str) -> Estimate:
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


def without_stray_cells(found: Estimate, settings: Constrained, name: str) -> Estimate:
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


def perturbed(found: Estimate, settings: Constrained, name: str) -> Estimate:
    """The best of what descents lead to that begin at ``found`` after jumps have cost something else for a while.

    Only where noise makes minima, and not through a correlation window, where what is gained is not worth the time.
    """
    if not found.problem.sharp:
        return found
    for change in found.problem.strategy.perturbations:
        other = {
            "regulariser_weight": change.weight * settings.regulariser_weight,
            "jump_scale": change.scale * settings.jump_scale,
            "iterations": min(change.iterations, settings.iterations),
        }
        away = descend(found.problem, settings.model_copy(update=other), name, found, (), 0.0)
        back = descend(found.problem, settings, name, away, (), settings.tolerance)
        found = likeliest(found, back.after(found, away))
    return found


def subdivided(found: Estimate, measurement, settings: Constrained, name: str) -> Estimate:
    """The field with cells divided into subcells, where interfaces lie anywhere and the data can tell where.

    A cell that an interface cuts is no material: neither does it deform as a mixture would, nor is it one. Subcells
    of it are both more nearly, and what is left of the misfit tells how much of the cell is which. It also tells how
    far finite elements describe the sheet, which depends on its contrast: where that is better than assumed, what was
    measured is trusted as far as it shows.
    """
    strategy = found.problem.strategy
    count = strategy.subcells**2 * len(found.params)
    if not found.problem.blurred or found.unexplained > 1.0 or count > strategy.most_subcells:
        return found
    terms, iterations = list(found.problem.basis.terms), min(strategy.subcells_iterations, settings.iterations)
    settings = settings.model_copy(update={"terms": terms, "iterations": iterations})
    problem = field_problem(measurement, settings, strategy.subcells, strategy)
    found = descend(problem, settings, name, found, (), settings.tolerance).after(found)
    misfit = float(found.history[-1])
    if problem.noisy or misfit > strategy.overestimated:
        return found
    error = max(misfit, strategy.smallest_reestimate) * problem.sigma
    problem = field_problem(measurement, settings, strategy.subcells, strategy, error)
    return descend(problem, settings, name, found, (), settings.tolerance).after(found)
