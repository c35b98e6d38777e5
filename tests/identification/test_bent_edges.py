"""Edges may be off by more where that explains most of what few materials leave, and nowhere else."""

from types import SimpleNamespace

import pytest
import xarray as xr

from hypernode.data.measurement import edges_bend_beside
from hypernode.identification.bent_edges import with_bent_edges


class Tried:
    """What a search tries, without its descents: each leaves what it is told to."""

    def __init__(self, leaves):
        self.measurement, self.leaves, self.descents, self.reasons = xr.Dataset(), leaves, [], {}

    def believe(self, measurement):
        self.measurement = measurement

    def problem(self, terms, subcells):
        return SimpleNamespace(terms=terms, subcells=subcells)

    def descend(self, move, start, *_):
        self.descents.append(start)
        return candidate(self.leaves)

    def passed_over(self, candidate, reason):
        self.reasons[candidate.misfit] = reason


def candidate(misfit, materials=2):
    found = SimpleNamespace(misfit=misfit, terms=(), subcells=1, u={}, leaves_mostly_no_noise=misfit > 2.0)
    found.fit = SimpleNamespace(window=2.0, field=SimpleNamespace(count=materials))
    found.halves = lambda other: other.leaves_mostly_no_noise and misfit**2 < 0.5 * other.misfit**2
    return found


@pytest.mark.parametrize(("misfit", "materials"), [(1.5, 2), (4.0, 1)])
def test_what_noise_explains_and_one_material_keep_their_edges(misfit, materials):
    trials, kept = Tried(0.1), candidate(misfit, materials)
    assert with_bent_edges(trials, kept, kept, [0], True) == (kept, kept)
    assert not trials.descents and not edges_bend_beside(trials.measurement)


@pytest.mark.parametrize(("leaves", "believed"), [(1.5, True), (3.0, False)])
def test_edges_are_believed_to_bend_only_where_that_halves_the_squares(leaves, believed):
    trials, kept, finer = Tried(leaves), candidate(5.0), candidate(4.0)
    found = with_bent_edges(trials, kept, finer, [0], True)
    assert edges_bend_beside(trials.measurement) is believed
    assert trials.descents == ([finer, kept] if believed else [finer])
    assert [each.misfit for each in found] == ([leaves, leaves] if believed else [5.0, 4.0])
    assert list(trials.reasons) == [4.0 if believed else leaves]
