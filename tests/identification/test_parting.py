"""When one more material is kept."""

from types import SimpleNamespace

import numpy as np
import pytest

from hypernode.identification import parting, small_steps
from hypernode.identification.parting import Parting


def candidate(misfit, materials=2, score=0.0, most_is_no_noise=True):
    """Scores of two are the difference of their own; ``halves`` is that of a candidate."""
    found = SimpleNamespace(score=score, fit=SimpleNamespace(misfit=misfit, field=SimpleNamespace(count=materials)))
    found.gain_over = lambda other: other.score - score
    found.halves = lambda other: most_is_no_noise and misfit**2 < 0.5 * other.fit.misfit**2
    return found


@pytest.mark.parametrize(
    ("kept", "found", "small", "word"),
    [
        (candidate(2.0, 1, 10.0), candidate(1.9, 2, 5.0), False, "scores"),
        (candidate(6.5, 2, 0.0), candidate(3.4, 3, 24.0), False, "squares"),
        (candidate(6.5, 2, 0.0), candidate(5.9, 3, 24.0), False, ""),
        (candidate(6.5, 1, 0.0), candidate(3.4, 2, 24.0), False, ""),
        (candidate(6.5, 1, 0.0), candidate(3.4, 2, 24.0), True, "squares"),
        (candidate(1.5, 2, 0.0), candidate(0.9, 3, 24.0, most_is_no_noise=False), False, ""),
    ],
)
def test_one_more_material_scores_better_or_halves_what_several_leave_beyond_noise(kept, found, small, word):
    why = Parting(None, [], False, small=small)._why_more(found, kept)
    assert bool(why) == bool(word) and word in why


@pytest.mark.parametrize("columns", [[0], [0, 1, 2]])
def test_a_gradual_change_begins_with_the_fibres_of_most_cells_where_cells_have_fibres(columns, monkeypatch):
    values = np.array([[0.5, 0.1, 0.0], [1.5, 0.1, 0.0]])[:, : len(columns)]
    known = SimpleNamespace(with_law=lambda materials: ("with law", materials))
    beside = SimpleNamespace(
        columns=columns,
        known=known,
        reached={},
        found=SimpleNamespace(values=values),
        parts=lambda count: (None, "fibres of most cells"),
        problem="with fibres",
    )
    one, kept, asked = candidate(9.0, 1, 20.0), candidate(5.0, 2, 10.0), {}
    with_fibres, gradual = candidate(8.0, 1, 19.0), candidate(1.0, 1, 0.0)

    def trend(trials, begun, field, factor, u, steps, finds_window, instead):
        asked.update(begun=begun, field=field, factor=factor)
        return gradual

    monkeypatch.setattr(parting, "trend", trend)
    descend, passed = (lambda *given: with_fibres), []
    trials = SimpleNamespace(descend=descend, passed_over=lambda each, why: passed.append(each))
    found = Parting(trials, [0], False)._gradual(one, beside, kept)
    assert found is gradual and passed == [kept]
    assert asked["begun"] is (with_fibres if len(columns) > 1 else one)
    if len(columns) > 1:
        assert asked["field"] == ("with law", "fibres of most cells")
        np.testing.assert_allclose(asked["factor"], [-0.5, 0.5])
    else:
        assert asked["field"] is known
        np.testing.assert_allclose(asked["factor"], [0.5, 1.5])


@pytest.mark.parametrize("small", [True, False])
def test_small_steps_try_every_number_of_materials_and_remember_the_first_that_was_more(small, monkeypatch):
    one = candidate(9.0, 1, 30.0)
    one.start, tried = None, []
    of_count = {2: candidate(5.0, 2, 10.0), 3: candidate(5.0, 3, 12.0), 4: candidate(4.9, 4, 14.0)}
    for each in (one, *of_count.values()):
        each.leaves_more_than_noise, each.fit.field.gradual = True, ()
    left = SimpleNamespace(misfit=6.0 if small else 1.0)
    beside = SimpleNamespace(found=left, known=SimpleNamespace(count=1), parts=lambda count: (None, [None] * count))
    search = Parting(SimpleNamespace(passed_over=lambda each, why: None), [0], False, small=small)
    monkeypatch.setattr(search, "of_parts", lambda begun, beside, count: tried.append(count) or of_count[count])
    monkeypatch.setattr(search, "_gradual", lambda begun, beside, kept: kept)
    monkeypatch.setattr(parting, "merged", lambda trials, kept, *rest: kept)
    assert search.parted(one, beside) is of_count[2]
    assert tried == ([2, 3, 4] if small else [2, 3]) and search.one_more is of_count[3]


@pytest.mark.parametrize("gain", [-5.0, 5.0])
@pytest.mark.parametrize(
    ("materials", "terms", "noise", "gradual", "asked"),
    [
        (4, ("fibre",), True, (), 1),
        (2, ("fibre",), True, (), 0),
        (2, ("fibre",), False, (), 1),
        (4, ("I2",), False, (), 0),
        (1, ("fibre",), False, (1.0,), 0),
    ],
)
def test_materials_with_fibres_stand_against_those_of_small_steps(materials, terms, noise, gradual, asked, gain):
    kept, other, passed = candidate(1.0, materials), candidate(1.0, 2, score=-gain), []
    for each in (kept, other):
        each.terms, each.leaves_more_than_noise, each.fit.field.gradual = terms, not noise, gradual
    same = {name: lambda each: each for name in ("lawful", "turned")}
    trials = SimpleNamespace(passed_over=lambda each, why: passed.append(each))
    moves = SimpleNamespace(trials=trials, **same)
    others = iter([other])
    found = small_steps.of_likeliest_cut(moves, kept, others)
    assert found is (other if asked and gain > 0.0 else kept) and len(list(others)) == 1 - asked
    assert passed == ([kept if gain > 0.0 else other] if asked else [])
