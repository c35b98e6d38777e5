"""When one more material is kept."""

from types import SimpleNamespace

import pytest

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
