"""Forces that no sheet gives are refused once its mean deformation is known, and those of real ones are not."""

import numpy as np
import pytest

from hypernode.config.methods import Constrained
from hypernode.identification.force_course import ImpossibleForcesError
from hypernode.identification.strategy import identify
from hypernode.mechanics.loads import make_load
from tests.sheets import sheet, square

# Whole identifications begin here, so that these are laws that `make laws` runs.
pytestmark = pytest.mark.slow
SETTINGS = Constrained(terms=["I1_squared"], iterations=1)
STRETCHES = [1.03, 1.06, 1.09, 1.12]
RECORDS = {
    "reversed": lambda f: -f,
    "constant": lambda f: 0.0 * f + f[-1:],
    "tenfold from one step on": lambda f: f * np.array([1.0, 1.0, 10.0, 10.0])[:, None, None],
    "of the steps in another order": lambda f: f[::-1],
}


@pytest.fixture(scope="module")
def pulled():
    return sheet(6, square, make_load("clamped_y", STRETCHES))[0]


@pytest.mark.parametrize("record", RECORDS)
def test_a_record_that_no_sheet_gives_stops_the_run_with_what_was_seen(pulled, record):
    force = pulled["edge_force"]
    wrong = pulled.assign(edge_force=(force.dims, RECORDS[record](force.values)))
    with pytest.raises(
        ImpossibleForcesError, match=r"s: the forces of load case 0 are missed by \d+%.*at F = \(.*sign"
    ):
        identify(wrong, SETTINGS, "s")


def test_the_forces_of_a_sheet_of_two_materials_are_believed(pulled):
    assert identify(pulled, SETTINGS, "sheet").params.shape == (36, 2)
