"""Which move from one candidate to another stands, and what is said of the one that is passed over."""

from types import SimpleNamespace

import numpy as np
import pytest

from hypernode.identification import moves as moves_of_search
from hypernode.identification.candidate import Candidate
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.law_search import LawSearch
from hypernode.identification.mosaic_search import MosaicSearch
from hypernode.identification.moves import Moves
from hypernode.identification.volume import Asked


def moving(monkeypatch, **moves):
    """(moves of which some are replaced, reasons by the identity of a candidate)."""
    reasons = {}
    trials = SimpleNamespace(passed_over=lambda kept, why: reasons.update({id(kept): why}))
    found = Moves(trials, [0], False)
    for name, move in moves.items():
        monkeypatch.setattr(found, name, move)
    return found, reasons


@pytest.mark.parametrize(
    ("refuted", "alike", "left", "taken"),
    [(True, False, 0.9, True), (False, False, 0.9, False), (True, True, 0.9, False), (True, False, 1.1, False)],
)
def test_a_gradual_change_that_scored_less_stands_where_only_few_materials_leave_the_same_in_all_steps(
    refuted, alike, left, taken, monkeypatch
):
    def candidate(misses, misfit):
        return SimpleNamespace(
            misses_deformation=misses, fit=SimpleNamespace(misfit=misfit, field=SimpleNamespace(gradual=()))
        )

    few, gradual = candidate(refuted, 1.0), candidate(alike, left)
    moves, reasons = moving(monkeypatch, with_law=lambda kept: kept, finer=lambda kept: kept)
    found = moves.gradual_instead(few, SimpleNamespace(gradual=gradual))
    assert (found is gradual) is taken and (id(few) in reasons) is taken


@pytest.mark.parametrize(
    ("mostly", "explained", "taken"), [(True, True, True), (True, False, False), (False, True, False)]
)
def test_whole_cells_end_the_search_where_lines_leave_mostly_no_noise_and_they_leave_only_noise(
    monkeypatch, mostly, explained, taken
):
    lines = SimpleNamespace(leaves_mostly_no_noise=mostly, leaves_more_than_noise=True)
    cells = SimpleNamespace(leaves_more_than_noise=not explained)
    monkeypatch.setattr(MosaicSearch, "instead_of", lambda self, kept, finer: cells)
    moves, reasons = moving(monkeypatch)
    assert (moves.of_whole_cells(lines) is cells) is taken
    assert (id(cells) in reasons) is (mostly and not explained)


@pytest.mark.parametrize(
    ("count", "noise", "level", "left", "asked", "taken"),
    [
        (2, False, 4.0, None, True, True),
        (2, False, 4.0, 2.0, True, True),
        (2, False, 4.0, 3.0, True, False),
        (2, False, 6.0, None, False, False),
        (2, True, 1.0, None, False, False),
        (1, False, 4.0, None, False, False),
    ],
)
def test_the_law_is_sought_on_finer_elements_where_they_change_as_much_as_coarse_ones_leave(
    monkeypatch, count, noise, level, left, asked, taken
):
    fit = SimpleNamespace(field=SimpleNamespace(count=count))
    coarse = SimpleNamespace(fit=fit, leaves_more_than_noise=not noise, level=level)
    finer, sought = SimpleNamespace(leaves_more_than_noise=left is not None, level=left), []
    same = {"lawful": lambda kept: sought.append(kept) or kept}
    monkeypatch.setattr(moves_of_search, "of_likelier_volume", lambda trials, kept, steps, finds: Asked(kept))
    monkeypatch.setattr(LawSearch, "with_law_of", lambda self, kept, other: None)
    moves, reasons = moving(monkeypatch, finer=lambda kept: finer, _missed_by_elements=lambda kept: 5.0, **same)
    found = moves.law_on_finer_elements(coarse)
    assert bool(sought) is asked
    assert found == ((coarse, finer) if taken else None)
    assert (id(finer) in reasons) is (asked and not taken)


@pytest.mark.parametrize(
    ("count", "halved", "gain", "taken"),
    [(1, False, 5.0, True), (1, False, -5.0, False), (1, True, 5.0, False), (2, False, 5.0, False)],
)
def test_one_material_stands_in_the_place_of_a_gradual_change_that_it_does_not_need(
    monkeypatch, count, halved, gain, taken
):
    field = SimpleNamespace(count=count, materials=[None] * count)
    gradual = SimpleNamespace(
        problem=SimpleNamespace(observations=SimpleNamespace(grid=None), refinement=None),
        fit=SimpleNamespace(field=field),
        u={},
        halves=lambda other: halved,
        gain_over=lambda other: 1.0,
    )
    alone = SimpleNamespace(gain_over=lambda other: gain, leaves_more_than_noise=True)
    monkeypatch.setattr(moves_of_search.Lines, "of", lambda *given: None)
    monkeypatch.setattr(Interfaces, "homogeneous", lambda *given: None)
    moves, reasons = moving(monkeypatch, of_one=lambda kept: alone, finer=lambda kept: kept)
    moves.trials.descend = lambda *given: SimpleNamespace()
    assert (moves.without_change(gradual, None) is alone) is taken
    assert (id(gradual) in reasons) is taken


@pytest.mark.parametrize("likelier", [True, False])
def test_the_volume_is_that_which_finer_elements_speak_for(monkeypatch, likelier):
    coarse, finer, other, like_it = (SimpleNamespace() for _ in range(4))
    asked = Asked(other if likelier else finer)
    monkeypatch.setattr(moves_of_search, "of_likelier_volume", lambda trials, kept, steps, finds: asked)
    monkeypatch.setattr(LawSearch, "with_law_of", lambda self, kept, law: like_it)
    moves, _ = moving(monkeypatch)
    assert moves.of_volume_told_finer(coarse, finer) == ((like_it, other) if likelier else (coarse, finer))


@pytest.mark.parametrize(("squared", "missed"), [(4.0, False), (17.0, False), (19.0, True)])
def test_forces_are_missed_where_chance_does_not_miss_them_so_far(squared, missed):
    # Four forces of the steps that count: at three standard deviations chance makes 17.8.
    forces = [SimpleNamespace(step=step) for step in (1, 1, 4, 4, 2)]
    fit = SimpleNamespace(steps=[1, 4], force_squared=squared)
    found = Candidate(move="", start=None, problem=SimpleNamespace(forces=forces), fit=fit, u={})
    assert found.misses_forces is missed


@pytest.mark.parametrize(("noise", "forces"), [(False, False), (True, False), (False, True)])
def test_a_law_may_turn_where_displacements_or_forces_are_missed(monkeypatch, noise, forces):
    tried = []
    field = Interfaces(None, np.zeros((1, 2)), np.zeros((0, 4)), np.zeros(3))
    kept = SimpleNamespace(
        fit=SimpleNamespace(field=field),
        leaves_more_than_noise=noise,
        misses_forces=forces,
        terms=("fibre",),
        problem=None,
        u={},
    )
    trials = SimpleNamespace(descend=lambda *given: tried.append(given[0]))
    assert Moves(trials, [0], False).turned(kept) is kept
    assert bool(tried) is (noise or forces)
