"""Terms of which no homogeneous sheet is in equilibrium are left out where a field can do without them."""

import pytest

from hypernode.config.methods import Constrained
from hypernode.identification import strategy
from hypernode.identification.gauss_newton import IdentificationError, descend
from hypernode.identification.strategy import identify
from hypernode.mechanics.loads import make_load
from tests.sheets import sheet, square

SETTINGS = Constrained(terms=["I1_squared", "fibre"], isotropic_terms=["I1_squared"], iterations=20)


@pytest.fixture
def without_equilibrium(monkeypatch):
    """A function that names a term of which no sheet is in equilibrium."""

    def name(term):
        def failing(problem, *arguments):
            if term in problem.basis.terms:
                raise IdentificationError("no equilibrium for the homogeneous material")
            return descend(problem, *arguments)

        monkeypatch.setattr(strategy, "descend", failing)

    return name


@pytest.mark.slow
def test_a_field_is_found_with_the_other_terms(without_equilibrium, capsys):
    without_equilibrium("fibre")
    values = {"log1p_I1_squared": 1.0}
    data, _, _ = sheet(5, square, make_load("equibiaxial", [1.1, 1.2]), noise=1e-3, values=values.items())
    found = identify(data, SETTINGS, "sheet")
    assert "fibre" not in found.basis.terms and found.unexplained <= 1.0
    data, _, _ = sheet(5, square, make_load("clamped_y", [1.2, 1.4]), terms=("fibre",), values=[("fibre_x", -0.9)])
    assert not identify(data, SETTINGS, "fibrous").basis.has_fibres
    assert "these terms are left out: no equilibrium" in capsys.readouterr().err


def test_without_any_other_it_is_an_error(without_equilibrium):
    without_equilibrium("J")
    data, _, _ = sheet(5, square, make_load("equibiaxial", [1.1]))
    with pytest.raises(IdentificationError, match="no equilibrium"):
        identify(data, Constrained(terms=["J"], isotropic_terms=[]), "sheet")
