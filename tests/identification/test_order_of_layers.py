"""Fields that are put in layers: the plainest that explain a test first, then the likeliest, then others."""

from types import SimpleNamespace

from hypernode.identification.layered import _in_order
from hypernode.identification.settings import STRATEGY


def field(*terms, misfit=1.0, unexplained=0.5):
    basis = SimpleNamespace(terms=terms, names=("log_level", *terms))
    problem = SimpleNamespace(basis=basis, strategy=STRATEGY)
    return SimpleNamespace(problem=problem, basis=basis, history=[9.0, misfit], unexplained=unexplained)


def test_plainer_terms_come_before_the_likeliest_and_richer_ones_after_it():
    found, plain = field("I1_squared", "I2"), field()
    one, other, richer = field("I1_squared"), field("I2", "ogden"), field("I1_squared", "I2", "fibre")
    assert _in_order(found, [richer, other, one, plain]) == [plain, one, found, richer, other]


def test_terms_that_miss_more_than_cut_cells_account_for_and_those_that_explain_nothing_are_left_out():
    found = field("I1_squared")
    missed = field(misfit=1.01 * STRATEGY.rival_misfit)
    unexplained = field("I2", unexplained=1.1)
    assert _in_order(found, [missed, unexplained]) == [found]


def test_of_several_fields_with_the_same_terms_the_likeliest_is_taken():
    found, earlier = field("I2"), field("I2")
    (only,) = _in_order(found, [earlier])
    assert only is found
