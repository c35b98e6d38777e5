"""Equilibrium as a constraint: the material field whose finite-element solution is what was measured.

Nothing measured is ever differentiated, so noise hardly matters. For every guess finite elements solve the equilibrium
of each load step. Gauss-Newton steps reduce the misfit of displacements and edge forces, in units of their noise.

A few materials come first, with lines between them, of whole cells, or one that changes gradually. Where none of these
explains the test, every cell has its own coefficients, and jumps between cells have a cost.
"""

import functools
import sys

import xarray as xr

from hypernode.config.methods import Constrained
from hypernode.data.coarsening import coarsened
from hypernode.identification import budgets, thresholds
from hypernode.identification.choice import likeliest
from hypernode.identification.estimate import Estimate
from hypernode.identification.force_course import check_forces
from hypernode.identification.gauss_newton import IdentificationError, descend
from hypernode.identification.interface_estimate import InterfaceEstimate
from hypernode.identification.interface_search import Search
from hypernode.identification.problem import FieldProblem, field_problem
from hypernode.identification.unseen_strips import with_carried_shares
from hypernode.identification.volume import Parts, of_either
from hypernode.progress import say
from hypernode.trace import table
from hypernode.verdict import Ending


def identify(measurement: xr.Dataset, settings: Constrained, name: str) -> Estimate:
    """The material field that explains a measurement, or comes nearest to it.

    Args:
        measurement: an opened measurement.
        settings: configuration of the stage.
        name: case, for progress and messages.

    Raises:
        IdentificationError: no equilibrium at the homogeneous start.
        ImpossibleForcesError: no sheet gives the forces.
    """
    found = of_either(
        settings,
        lambda each: of_parts(measurement, each, name),
        lambda each: of_cells(measurement, each, name),
    )
    told = None if isinstance(found, InterfaceEstimate) else with_carried_shares(measurement, found)
    if told is not None:
        of_law = settings.model_copy(update={"terms": list(found.basis.terms)})
        problem = field_problem(told, of_law)
        found = descend(problem, of_law, name, found, settings.tolerance, "what is beside the points").after(found)
    for line in table(found.trace.rows(found.trial)):
        say("constrained", name, line)
    _warn(found, settings, name)
    return found


def of_parts(measurement: xr.Dataset, settings: Constrained, name: str) -> Parts:
    """The few materials and lines that explain a test. They are sought where the configuration asks for layers.

    Args:
        measurement: an opened measurement.
        settings: configuration of the stage.
        name: case, for progress and messages.

    Raises:
        ImpossibleForcesError: no sheet gives the forces.
    """
    if not settings.layers:
        return Parts(None, False)
    search = Search(measurement, settings, name)
    found = search.end()
    if found is None or found.unexplained > 1.0 or found.misfits["displacement"] > thresholds.MOSTLY_NO_NOISE:
        found = None
    return Parts(found, search.keeps_volume)


def of_cells(measurement: xr.Dataset, settings: Constrained, name: str) -> Estimate:
    """The likeliest field in which every cell has its own coefficients.

    The stiffness alone comes first: it finds where the material changes, along a path without the valleys that all
    coefficients together make. Then come laws without fibres, those of the basis, and the further terms if no field
    explains the test. A grid of many cells begins at the field of every second of its lines.
    """

    @functools.cache
    def problem_of(*terms: str) -> FieldProblem:
        return field_problem(measurement, settings.model_copy(update={"terms": list(terms)}))

    def with_terms(terms, before: Estimate | None, move: str) -> Estimate | None:
        """Where a descent ends; None without equilibrium where there is a field already."""
        try:
            reached = descend(problem_of(*terms), settings, name, before, settings.tolerance, move)
        except IdentificationError as error:
            if before is None:
                raise
            say("constrained", name, f"these terms are left out: {error}")
            return None
        return reached if before is None else reached.after(before)

    if measurement.sizes["cell"] > budgets.MOST_CELLS_AT_ONCE:
        coarse = coarsened(measurement)
        say("constrained", name, f"{coarse.sizes['cell']} cells of every second grid line first")
        before = of_cells(coarse, settings, name).without_sensitivities()
        return with_terms(before.basis.terms, before, "cells of the measured grid")
    check_forces(problem_of, settings, name)
    # Whether the sheet is compressible is no term among others: it says what the stiffness means.
    plain = with_terms([term for term in settings.terms if term == "J"], None, "cells, from the homogeneous sheet")
    if plain.data_share < thresholds.NOTHING_LEFT or plain.basis.terms == tuple(settings.terms):
        return plain
    laws = [settings.isotropic_terms] if settings.isotropic_terms and "fibre" in settings.terms else []
    tried = [plain, *(with_terms(terms, plain, "cells, with these terms") for terms in (*laws, settings.terms))]
    found = likeliest(*(each for each in tried if each is not None))
    if settings.further_terms and found.underfitted and set(found.basis.terms) <= set(settings.terms):
        more = with_terms([*settings.terms, *settings.further_terms], found, "cells, with further terms")
        found = found if more is None else likeliest(found, more)
    return found


def _warn(found: Estimate, settings: Constrained, name: str) -> None:
    """Say on standard error what stands against believing a field."""
    misfit = found.misfits["displacement"]
    if misfit > thresholds.UNEXPLAINED:
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
