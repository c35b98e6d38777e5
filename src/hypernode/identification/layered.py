"""A noisy sheet of two materials whose interface lies anywhere: cells that it cuts are layers of both.

Whether the sheet is made so is no assumption: such a field is kept where it is the likelier one.
"""

from collections.abc import Sequence

from hypernode.config.methods import Constrained
from hypernode.identification.choice import reason_against
from hypernode.identification.estimate import Estimate
from hypernode.identification.layered_descent import LayeredDescent
from hypernode.identification.phases import of_one_material


def in_layers(found: Estimate, tried: Sequence[Estimate], settings: Constrained, name: str) -> Estimate:
    """The field of two materials and a line that explains a noisy test, if it is likelier than ``found``, or that.

    Two materials may need less of a law than mixtures do, which the plainest terms explain badly and richer ones by
    what is not there. So fields with plainer terms are put in layers first.

    Args:
        tried: fields with other terms, in any order.
    """
    problem = found.problem
    observations = problem.observations
    may_be = problem.noisy and not observations.own_grid and not problem.divided and observations.by_points
    if not (settings.layers and may_be) or found.unexplained > 1.0:
        return found
    best = None
    for free in _in_order(found, tried):
        descent = LayeredDescent.along(best.distance, free, name) if best else LayeredDescent.of_halves(free, name)
        reached = descent and descent.end()
        if reached is None:
            continue
        reached = reached.recorded("two materials and a line", free)
        if reached.underfitted:
            found = found.instead_of(reached, because="does not explain the test")
            continue
        if best is None:
            best = reached.after(free)
        elif reached.information_criterion < best.information_criterion:
            best = reached.after(free).instead_of(best, because=reason_against(best, reached))
        else:
            best = best.instead_of(reached, because=reason_against(reached, best))
        if not best.ambiguous and best.information_criterion < found.information_criterion:
            break
    if best is None:
        return found
    plainer = [each for each in (found, of_one_material(found)) if each is not None]
    rival = min(plainer, key=lambda each: each.information_criterion)
    if rival.information_criterion <= best.information_criterion:
        for each in plainer[1:]:
            found = found.instead_of(each, because=reason_against(each, found))
        return found.instead_of(best, because=reason_against(best, rival))
    for each in plainer:
        best = best.instead_of(each, because=reason_against(each, best))
    return best


def _in_order(found: Estimate, tried: Sequence[Estimate]) -> list[Estimate]:
    """Fields with plainer terms that explain a test, from the fewest parameters on, ``found``, and those with others.

    Not those that miss displacements by so much more that what interfaces cut does not account for it.
    """
    as_well = found.problem.strategy.rival_misfit * float(found.history[-1])
    explained = [each for each in tried if each.unexplained <= 1.0 and each.history[-1] <= as_well]
    of_terms = {each.problem.basis.terms: each for each in (*explained, found)}
    count = len(found.basis.names)
    return sorted(of_terms.values(), key=lambda each: (min(len(each.basis.names), count), each is not found))
