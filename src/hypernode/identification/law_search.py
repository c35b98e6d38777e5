"""Search for the terms of the law: one after the other, as long as the score improves."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from hypernode.config.methods import Constrained
from hypernode.identification import budgets, priors, thresholds
from hypernode.identification.candidate import Candidate
from hypernode.identification.points import Points
from hypernode.identification.problem import FieldProblem
from hypernode.identification.score_test import BELONGS, Joined, price, score_test
from hypernode.identification.trials import Trials
from hypernode.mechanics.convex_basis import FIBRE_VECTOR

#: Terms that contain the thickness, which J leaves open.
OF_THICKNESS = ("I2", "ogden")
#: Parameter of fibres that says nothing where they have no strength.
SHAPE_OF_FIBRES = "logit_dispersion"


class LawSearch:
    """The search for terms on one test.

    Args:
        steps: load steps that count.
        finds_window: whether the side of the window is sought.
        settled: how positions of materials are updated after a change of the law; by default lines are fitted again.
    """

    def __init__(
        self,
        trials: Trials,
        steps: list[int],
        finds_window: bool,
        settled: Callable[[Candidate], Candidate] | None = None,
    ):
        self._trials, self._steps, self._finds = trials, steps, finds_window
        self._settled = settled or self._lines_again

    def end(self, kept: Candidate, most: int | None = None) -> Candidate:
        """Add terms one after the other as long as the score improves; the lines are fitted again.

        Of the terms that promise to improve it, the two that promise most are tried, and the better one is kept. The
        other one may be better still with a further term. That is tried too, where the further term promises it.

        Args:
            most: how often terms may join; as many as there are if left out.
        """
        for _ in range(budgets.MOST_TERMS if most is None else most):
            if kept.leaves_nothing:
                break
            # Near noise the linear model is exact.
            begun = self._next(kept, 0.0 if kept.leaves_more_than_noise else thresholds.EVIDENCE)
            tried = self._followed(begun)
            best = self._best(kept, tried)
            if best is kept:
                break
            for other in tried:
                if other is not best and other.gain_over(kept) > 0.0:
                    best = self._best(best, self._next(other, best.gain_over(other), most=1))
            kept = best if best in tried and best not in begun else self._settled(best)
        return kept

    def _followed(self, tried: list[Candidate]) -> list[Candidate]:
        """Two laws once their lines follow them, where lines of the law before leave more than the laws differ by.

        They do where both laws leave more than noise. Where most is no noise, elements or materials are to blame.
        """
        open_ = all(found.leaves_more_than_noise and not found.leaves_mostly_no_noise for found in tried)
        return [self._settled(found) for found in tried] if open_ and len(tried) > 1 else tried

    def _next(self, start: Candidate, asked: float, most: int | None = None) -> list[Candidate]:
        """Candidates with one term more, those first that promise most; none that promises no more than is asked."""
        terms = open_terms(start.terms, self._trials.settings)
        if not terms:
            return []
        score = score_test(start, terms)
        promises = {term: _promise(score.joined(term), start) for term in terms}
        self._trials.promised(start, {term: gain for term, (gain, _) in promises.items()})
        promising = [term for term in sorted(terms, key=lambda term: -promises[term][0]) if promises[term][0] > asked]
        tried = (
            self._with(start, term, promises[term][1])
            for term in promising[: budgets.TERMS_TRIED if most is None else most]
        )
        return [found for found in tried if found is not None]

    def _best(self, kept: Candidate, tried: list[Candidate]) -> Candidate:
        """The candidate, or one of others for which there is evidence against it."""
        best = kept
        for found in tried:
            gain = found.gain_over(best)
            if gain > thresholds.EVIDENCE:
                self._trials.passed_over(best, f"scores {gain:+.1f} against the law with {found.terms[-1]}")
                best = found
            else:
                more = best.terms == found.terms[:-1]
                against = f"without {found.terms[-1]}" if more else f"with {best.terms[-1]}"
                self._trials.passed_over(found, f"scores {-gain:+.1f} against the law {against}")
        return best

    def plainer(self, kept: Candidate) -> Candidate:
        """The law without terms that data hardly tell from none, as long as they gain less than evidence asks for.

        On coarse elements a term may pay for what elements miss, and so may a volume that changes. Fibres that small
        steps brought may be of another law. What lines would make of another law is not known to first order, so that
        a descent decides.
        """
        trials = self._trials
        while term := self._hardly_told(kept):
            found = self._of_terms(kept, _without(kept.terms, term), f"without {term}", move_lines=True)
            if found is None:
                break
            gain = found.gain_over(kept)
            if gain <= -thresholds.EVIDENCE or kept.halves(found):
                why = f"scores {-gain:+.1f} against" if gain <= -thresholds.EVIDENCE else "leaves twice the squares of"
                trials.passed_over(found, f"{why} the law with {term}")
                break
            trials.passed_over(kept, f"scores {gain:+.1f} against the law without {term}")
            kept = found
        return kept

    def _hardly_told(self, kept: Candidate) -> str | None:
        """The term that data tell least, if they hardly tell it from none (Wald's test).

        A volume that changes is asked for last: it says what all other terms mean, and no number of it is none.
        """
        names, fit, squared = kept.problem.basis.names, kept.fit, {}
        for term in (term for term in kept.terms if term != "J"):
            plain = self._trials.with_terms(kept, _without(kept.terms, term)).basis.names
            own = [name not in (*plain, SHAPE_OF_FIBRES) for name in names]
            own = np.flatnonzero(np.tile(own, fit.field.count))
            values, covariance = fit.field.materials.ravel()[own], fit.covariance[np.ix_(own, own)]
            squared[term] = values @ np.linalg.solve(covariance, values)
        least = min(squared, key=squared.get, default=None)
        if least and squared[least] < thresholds.APART**2:
            return least
        return "J" if "J" in kept.terms and "J" not in self._trials.settings.terms else None

    def with_law_of(self, kept: Candidate, other: Candidate) -> Candidate | None:
        """A candidate with the law of another one, on its own elements; None without equilibrium."""
        return self._of_terms(kept, other.terms, "the same law on coarse elements", move_lines=False)

    def _of_terms(self, kept: Candidate, terms: tuple[str, ...], move: str, move_lines: bool) -> Candidate | None:
        """A candidate with other terms, from materials as stiff as its own; None without equilibrium."""
        problem, window = self._trials.with_terms(kept, terms), kept.fit.window
        field = kept.fit.field.with_law(translated(kept.fit.field.materials, kept.problem, problem))
        finds, u = self._finds and move_lines, kept.u
        return self._trials.descend(
            move, kept, problem, field, u, self._steps, budgets.NEAR, window, finds, move_lines=move_lines
        )

    def _lines_again(self, kept: Candidate) -> Candidate:
        """Lines that follow another law."""
        if kept.fit.field.count == 1:
            return kept
        u, window, near = kept.u, kept.fit.window, not kept.leaves_mostly_no_noise
        move, most = f"lines with {kept.terms[-1]}", budgets.NEAR if near else budgets.DISPLACED_LINES
        found = self._trials.descend(
            move, kept, kept.problem, kept.fit.field, u, self._steps, most, window, self._finds, settled=near
        )
        return found or kept

    def _with(self, kept: Candidate, term: str, direction: int) -> Candidate | None:
        """The same lines between materials of a law with one term more, fibres from a direction."""
        problem, window = self._trials.with_terms(kept, (*kept.terms, term)), kept.fit.window
        begun = turned(translated(kept.fit.field.materials, kept.problem, problem), problem, term)[direction]
        field = kept.fit.field.with_law(begun)
        return self._trials.descend(
            f"with {term}", kept, problem, field, kept.u, self._steps, budgets.NEAR, window, move_lines=False
        )


def _without(terms: Sequence[str], term: str) -> tuple[str, ...]:
    """Terms without one of them, and without those that say more of it."""
    return tuple(other for other in terms if other != term and BELONGS.get(other) != term)


def open_terms(kept: Sequence[str], settings: Constrained) -> tuple[str, ...]:
    """Terms of the configuration that may join a law: those which say nothing of a term that is not there.

    J is another law.
    """
    every = dict.fromkeys([*settings.isotropic_terms, *settings.terms, *settings.further_terms])
    # One test hardly tells fibres and a volume that changes from one another.
    told = (*OF_THICKNESS, "fibre") if "J" in kept and "J" not in settings.terms else ()
    known = (*kept, *told, "J")
    return tuple(term for term in every if term not in known and BELONGS.get(term, term) in (*kept, term))


def _promise(joined: list[Joined], kept: Candidate) -> tuple[float, int]:
    """(by how much a term promises to improve the score, number of the direction from which fibres go)."""
    promised = []
    for number, each in enumerate(joined):
        x, gain = each.least(priors.LAW_HELD)
        cost = price(kept, len(each.new), np.count_nonzero(x))
        stronger = int(np.argmax(x.reshape(kept.fit.field.count, -1).sum(axis=0)))
        promised.append((gain - cost, (number + stronger) % len(joined)))
    return max(promised)


def turned(materials: np.ndarray, problem: FieldProblem, term: str) -> list[np.ndarray]:
    """Materials from which a term may begin: with fibres in four directions, else these alone."""
    if term != "fibre":
        return [materials]
    columns, found = [problem.basis.names.index(name) for name in FIBRE_VECTOR], []
    for doubled in np.arange(4) * np.pi / 2.0:
        turned = materials.copy()
        turned[:, columns] = np.hypot(*materials[0, columns]) * np.array([np.cos(doubled), np.sin(doubled)])
        found.append(turned)
    return found


def translated(before: np.ndarray, of: FieldProblem, problem: FieldProblem, begin: Mapping | None = None) -> np.ndarray:
    """Materials of another law: parameters that both have, others as the law begins, as stiff at the test's mean.

    Args:
        before: materials of the law of ``of`` (material, parameter).
        begin: values of parameters that begin otherwise, by name.
    """
    names, old = problem.basis.names, of.basis.names
    materials = np.tile(problem.basis.start, (len(before), 1))
    for k, name in enumerate(names):
        if name in old:
            materials[:, k] = before[:, old.index(name)]
        elif begin and name in begin:
            materials[:, k] = begin[name]
    materials[:, 0] += stiffness_of(of, before) - stiffness_of(problem, materials)
    return materials


def stress_of(problem: FieldProblem, materials: np.ndarray) -> np.ndarray:
    """Stress of each material under the mean deformation of the sheet, over its size (material, component)."""
    F, scale = problem.observations.mean_F, problem.observations.loading.scale
    count, steps = len(materials), F.shape[2]
    P, _ = Points(problem.basis).stress(np.tile(F, count), np.repeat(materials.T, steps, axis=1))
    return np.moveaxis(P.reshape(2, 2, count, steps) / scale, 2, 0).reshape(count, -1)


def stiffness_of(problem: FieldProblem, materials: np.ndarray) -> np.ndarray:
    """Logarithm of the stress of each material under the mean deformation of the sheet."""
    return 0.5 * np.log((stress_of(problem, materials) ** 2).sum(axis=1))
