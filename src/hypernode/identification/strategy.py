"""Equilibrium as a constraint: the material field whose finite-element solution is what was measured.

The unknown is a field of convex-basis coefficients, one set a cell. For every guess finite elements solve the
equilibrium of each load step. Gauss-Newton steps reduce the misfit of displacements and edge forces, in units of their
noise, together with the jumps of the field. Nothing measured is ever differentiated, so noise hardly matters.

The stiffness alone comes first: one number a cell finds where the material changes, along a path without the valleys
that all coefficients together make. From there the other terms are released. Where noise makes many minima, a field of
a few phases is kept if it is the likelier one. Otherwise the field is perturbed out of its own minimum, to see whether
there is a better one. Where interfaces lie anywhere, cells are then divided. Under noise, and if the sheet is of two
materials, cells that the interface cuts are layers of both instead.
"""

import functools
import sys
from dataclasses import replace

from hypernode.config.methods import Constrained
from hypernode.data.believed_noise import BelievedNoise, NoiseSource
from hypernode.data.coarsening import coarsened
from hypernode.identification.choice import likeliest
from hypernode.identification.estimate import Estimate
from hypernode.identification.finer_grid import from_coarser_grid
from hypernode.identification.force_course import check_forces
from hypernode.identification.gauss_newton import IdentificationError, descend
from hypernode.identification.interface_search import of_parts
from hypernode.identification.other_minima import (
    perturbed,
    with_law_of_sheet,
    without_fibres,
    without_outlying_cells,
    without_stray_cells,
)
from hypernode.identification.phases import in_phases
from hypernode.identification.problem import field_problem
from hypernode.identification.refuted_noise import refuted_noise
from hypernode.identification.settings import STRATEGY, Strategy
from hypernode.identification.subcells import rivals, subdivided
from hypernode.progress import say
from hypernode.trace import table
from hypernode.verdict import Ending


def identify(measurement, settings: Constrained, name: str, strategy: Strategy = STRATEGY) -> Estimate:
    """The material field that explains a measurement, or comes nearest to it.

    A few materials and lines between them, where these explain it; else a field of cells, see :func:`_field`.
    Where not even errors that points or steps seem to share explain what a field leaves, they are no errors but
    deformation: then each counts as an independent one. Where the field shows that noise is of another size than
    believed, a field is identified with that. Where noise does not explain what may as well be the error of finite
    elements, that error counts beside it.

    Args:
        measurement: an opened measurement.
        settings: configuration of the stage.
        name: case, for progress and messages.

    Raises:
        IdentificationError: no equilibrium at the homogeneous start.
    """
    parts = of_parts(measurement, settings, name, strategy)
    if parts is not None:
        return _said(parts, settings, name)
    found, _ = _field(measurement, settings, name, strategy)
    if found.problem.observations.scatter < 1.0 and found.unexplained > 1.0:
        misfit = found.misfits["displacement"]
        say("constrained", name, f"misfit {misfit:.2g}: what steps share is no noise; each error counts as its own")
        measurement = BelievedNoise(NoiseSource.INDEPENDENT).of(measurement)
        again = _field(measurement, settings, name, strategy)[0]
        found = again.instead_of(found, because="again with errors that nothing shares")
    refuted = refuted_noise(found, measurement)
    if refuted is not None:
        misfit = found.misfits["displacement"]
        say("constrained", name, f"misfit {misfit:.2g}: noise is not as believed; again with {refuted}")
        measurement = refuted.of(measurement)
        again = _field(measurement, settings, name, strategy)[0]
        found = again.instead_of(found, because=f"again with noise {refuted}")
    if found.problem.observations.contested and found.unexplained > 1.0:
        say("constrained", name, "noise does not explain it; that interfaces cut cells is counted beside it")
        again = _field(measurement, settings, name, replace(strategy, noise_rules=1.0))[0]
        found = again.instead_of(found, because="again with the error of elements beside the noise")
    return _said(found, settings, name)


def _said(found: Estimate, settings: Constrained, name: str) -> Estimate:
    """The same, once its trace and what speaks against it are said."""
    for line in table(found.trace.rows(found.trial)):
        say("constrained", name, line)
    _warn(found, settings, name)
    return found


def _field(measurement, settings: Constrained, name: str, strategy: Strategy) -> tuple[Estimate, list[Estimate]]:
    """The stiffness alone, then the terms of the basis: (the field that is kept, those that were tried).

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
        move = "cells, from the homogeneous sheet" if before is None else "cells, with these terms"
        reached = descend(problem_of(*terms), settings, name, before, plateaus, tolerance, move)
        return reached if before is None else reached.after(before)

    def if_in_equilibrium(terms, before, plateaus):
        """The field in a list, which is empty where other terms may do without these."""
        try:
            return [with_terms(terms, before, plateaus)]
        except IdentificationError as error:
            say("constrained", name, f"these terms are left out: {error}")
            return []

    # Whether the sheet is compressible is no term among others: it says what the stiffness means.
    first = [term for term in settings.terms if term == "J"]
    further = strategy.further_plateaus if settings.further_terms else ()
    plain, coarse = None, on_coarser_grid(measurement, settings, name, strategy)
    if coarse is None:
        # A coarse grid has the forces of the finer one.
        check_forces(problem_of, settings, name)
    if coarse is not None:
        finer, kept = from_coarser_grid(problem_of, first, settings, coarse, name)
        if kept:
            return finer, []
        # Without noise, the finer grid tells what interfaces that cut coarse cells may have hidden.
        tried, doubtful = [finer], finer.ambiguous or (finer.problem.certain and not finer.complete)
        if doubtful and not set(settings.terms) <= set(finer.problem.basis.terms):
            tried += if_in_equilibrium(settings.terms, finer, further)
    elif settings.terms == first:
        tried = [with_terms(first, None, further)]
    else:
        plain = with_terms(first, None, strategy.stiffness_plateaus, strategy.stiffness_tolerance)
        tried = _beside(plain, first, settings, strategy, name, if_in_equilibrium)
    found = likeliest(*tried)
    if settings.further_terms and found.underfitted:
        tried = [found, *_with_further_terms([plain, *tried], settings, strategy, if_in_equilibrium)]
        found = likeliest(*tried)
    kept = _settled(found, tried, measurement, settings, name, from_coarse=coarse is not None)
    return kept, [each for each in (plain, *tried) if each is not None]


def _beside(plain: Estimate, first: list[str], settings: Constrained, strategy: Strategy, name: str, field_of) -> list:
    """Fields with the terms of the basis, with and without fibres, that begin at the stiffness; or that of it alone."""
    if plain.data_share < strategy.nothing_left:
        return [plain]
    # Where the stiffness alone explains a noisy test, it stands for itself beside richer terms; not where
    # interfaces cut cells, which as mixtures are no such material.
    alone = plain.problem.noisy and plain.problem.observations.own_grid and not plain.ambiguous
    further = strategy.further_plateaus if settings.further_terms else ()
    tried = field_of(first, plain, ()) if alone else []
    if settings.isotropic_terms and "fibre" in settings.terms:
        tried += field_of(settings.isotropic_terms, plain, strategy.isotropic_plateaus)
    if not any(each.complete for each in tried):
        tried = field_of(settings.terms, plain, further) + tried
    tried = tried or [plain]
    # Without noise, forces of a field that explains the test leave the law of another one no doubt.
    if plain.problem.noisy or likeliest(*tried).ambiguous:
        tried = [_as_one_law(each, settings, name) for each in tried]
    return tried + field_of(settings.terms, None, further) if likeliest(*tried).ambiguous else tried


def _as_one_law(found: Estimate, settings: Constrained, name: str) -> Estimate:
    """What is likelier than a field without fibres that follows displacements and still leaves the test ambiguous.

    Which fibres a whole sheet has, its forces do not tell; see :func:`with_law_of_sheet`.
    """
    told = not found.basis.has_fibres and len(found.basis.names) > 1
    followed = found.history[-1] <= found.problem.strategy.unexplained
    return with_law_of_sheet(found, settings, name) if told and followed and found.ambiguous else found


def _with_further_terms(tried: list[Estimate | None], settings: Constrained, strategy: Strategy, field_of) -> list:
    """Fields that have the further terms as well, the last of which, that makes the longest valleys, comes last."""
    terms, last = [*settings.terms, *settings.further_terms], strategy.last_term
    soon = [term for term in terms if term != last]
    plateaus = strategy.further_plateaus if last in terms else ()
    found = field_of(soon, _beginning(tried, soon), plateaus)
    return found + field_of(terms, found[-1], ()) if found and last in terms else found


def _beginning(tried: list[Estimate | None], terms: list[str]) -> Estimate | None:
    """The first of some fields that a descent with these terms may begin from: one with none but them."""
    return next((each for each in tried if each and set(each.problem.basis.terms) <= set(terms)), None)


def _settled(
    found: Estimate, tried: list[Estimate], measurement, settings: Constrained, name: str, from_coarse: bool
) -> Estimate:
    """The best field near the likeliest of those that were tried, in other minima, or divided into subcells.

    Args:
        from_coarse: whether it began on a coarser grid, where other minima have been looked for.
    """
    found = in_phases(without_fibres(found, settings, name), name)
    if found.phases is not None:
        return found
    found = without_stray_cells(found, settings, name)
    if not from_coarse:
        found = perturbed(found, settings, name)
    found = without_outlying_cells(found, settings, name)
    divided = [subdivided(each, measurement, settings, name) for each in (found, *rivals(found, tried))]
    return without_outlying_cells(likeliest(*divided), settings, name)


def on_coarser_grid(measurement, settings: Constrained, name: str, strategy: Strategy) -> Estimate | None:
    """The field of every second grid line, which a grid of many cells begins from; None where there are few.

    Where interfaces are, and which terms there are, a coarse grid tells in a fraction of the time; the finer one moves
    interfaces by parts of a coarse cell.
    """
    if measurement.sizes["cell"] <= strategy.most_cells_at_once:
        return None
    coarse = coarsened(measurement)
    say("constrained", name, f"{coarse.sizes['cell']} cells of every second grid line first")
    found, _ = _field(coarse, settings, name, replace(strategy, most_subcells=0))
    # Of its sensitivities nothing is needed any more, and they are most of what it has.
    return replace(found, linear=None, step=None)


def _warn(found: Estimate, settings: Constrained, name: str) -> None:
    """Say on standard error what stands against believing a field."""
    misfit, strategy = found.misfits["displacement"], found.problem.strategy
    if misfit > strategy.unexplained:
        print(
            f"warning: constrained field of {name}: displacements are missed by {misfit:.1f} times their "
            f"noise. The terms ({', '.join(found.basis.terms) or 'neo-Hookean'}) do not explain this test, or "
            "the descent ended early: trust no number of this field; add further_terms or iterations",
            file=sys.stderr,
        )
    if found.ending is not Ending.CONVERGED:
        print(
            f"warning: constrained field of {name}: not converged ({found.ending}): {found.summary}; "
            f"allow more iterations than {settings.iterations}, or doubt what depends on its last digits",
            file=sys.stderr,
        )
