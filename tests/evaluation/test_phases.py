"""An inclusion is what the test can tell from noise, and nothing else is."""

import numpy as np
import pytest

from hypernode.data.measurement import mesh_of
from hypernode.evaluation.judge import judge
from hypernode.evaluation.phases import FLOOR, MOST, NONE, NOT_JUDGED, SEEN, find_phases, needed_of, score_phases
from hypernode.evaluation.shape import dice, find_inclusion
from hypernode.mechanics.loads import make_load
from tests.evaluation.files import square_mesh
from tests.evaluation.test_judge import STRETCHES, TERMS, run_of
from tests.sheets import believed, sheet, square

MESH = square_mesh(20)
CELLS = len(MESH.cells)
DISC = ((MESH.centres - 0.5) ** 2).sum(axis=1) < 0.25**2
NOISE = 0.03


def median_of_neighbours(mesh, values):
    """Medians over the cells, up to eight, that share a side or a corner with each; its own value without any."""
    pairs = mesh.touching()
    cell, other = np.concatenate([pairs, pairs[:, ::-1]])[np.argsort(pairs.T, axis=None, kind="stable")].T
    place = np.arange(len(cell)) - np.searchsorted(cell, cell)
    around = np.full((8, *values.shape), np.nan)
    around[place, cell] = values[other]
    alone = np.bincount(cell, minlength=len(values)) == 0
    around[0, alone] = values[alone]
    return np.nanmedian(around, axis=0)


def smooth(rng, count, scale=NOISE):
    """Fields that vary from cell to cell and over several cells, as those of a regularised problem do."""
    fields = rng.normal(size=(count, CELLS))
    for _ in range(2):
        fields = 0.5 * fields + 0.5 * median_of_neighbours(MESH, fields.T).T
    return scale * fields / fields.std()


def contrasted(contrast):
    """A sheet whose disc is stiffer by this, with noise, and the deviations of eight samples."""
    drawn = smooth(np.random.default_rng(3), 9)
    return 1.0 + contrast * DISC + drawn[0], drawn[1:]


def test_noise_of_the_posterior_is_no_inclusion():
    drawn = (smooth(np.random.default_rng(seed), 9) for seed in range(20))
    found = [find_phases(MESH, 1.0 + each[0], each[1:]).count > 1 for each in drawn]
    assert sum(found) <= 1


def test_a_contrast_of_three_times_the_threshold_is_found():
    share = DISC.mean()
    needed = find_phases(MESH, *contrasted(0.0)).needed
    assert needed > FLOOR
    phases = find_phases(MESH, *contrasted(3.0 * needed / np.sqrt(share * (1.0 - share))))
    assert phases.seen == pytest.approx(3.0 * needed, rel=0.2)
    assert phases.count == 2 and dice(phases.shape, DISC) > 0.9


def test_the_contrast_of_a_fifth_of_the_sheet_that_is_said_to_be_detectable_is():
    deviations = contrasted(0.0)[1]
    there = score_phases(MESH, np.ones(CELLS), deviations, noisy=True).summary["detectable_contrast"]
    fifth = MESH.centres[:, 0] < 0.2
    for factor, wanted in ((1.01, SEEN), (0.99, NONE)):
        judged = score_phases(MESH, 1.0 + factor * there * fifth, deviations, noisy=True)
        assert judged.summary["inclusion"] == wanted


@pytest.mark.parametrize(("scale", "block", "smaller"), [(1.0, (2, 2), (1, 1)), (6.0, (3, 4), (2, 3))])
def test_the_smallest_phase_that_is_said_to_be_distinguishable_is(scale, block, smaller):
    deviations = scale * contrasted(0.0)[1]
    said = score_phases(MESH, np.ones(CELLS), deviations, noisy=True).summary["smallest_phase"]
    assert np.prod(smaller) / CELLS < said <= np.prod(block) / CELLS
    for (rows, columns), wanted in ((block, SEEN), (smaller, NONE)):
        phase = np.zeros((20, 20))
        phase[6 : 6 + rows, 9 : 9 + columns] = 1.0
        assert score_phases(MESH, 1.0 + phase.ravel(), deviations, noisy=True).summary["inclusion"] == wanted


def test_wild_single_cells_neither_make_nor_hide_an_inclusion():
    rng = np.random.default_rng(1)
    wild = np.arange(CELLS).reshape(20, 20)[2:18:5, 3:18:5].ravel()
    for contrast in (0.0, 0.6):
        field, deviations = contrasted(contrast)
        calm = find_phases(MESH, field, deviations)
        field[wild[::2]] *= 40.0
        deviations[:, wild] += 200.0 * rng.normal(size=(8, len(wild)))
        phases = find_phases(MESH, field, deviations)
        assert phases.count == calm.count == 1 + (contrast > 0.0)
        assert phases.needed == pytest.approx(calm.needed, rel=0.15)
        assert dice(phases.shape, calm.shape) > 0.95


def test_one_wild_sample_hides_no_inclusion():
    field, deviations = contrasted(0.3)
    deviations[4] *= 100.0
    assert find_phases(MESH, field, deviations).count == 2
    assert needed_of(np.array([1.0] * 7 + [100.0])) == 1.0


def test_cells_of_samples_without_a_stress_do_not_count():
    field, deviations = contrasted(0.3)
    whole = find_phases(MESH, field, deviations[:7])
    deviations[:, ::50] = np.nan
    deviations[7] = np.nan
    phases = find_phases(MESH, field, deviations)
    assert phases.needed == pytest.approx(whole.needed, rel=0.1) and phases.count == 2


def test_three_phases_are_three_in_the_order_of_their_stiffness():
    drawn = smooth(np.random.default_rng(3), 9)
    x = MESH.centres[:, 0]
    true = np.digitize(x, [0.3, 0.6])
    phases = find_phases(MESH, np.array([1.0, 2.0, 1.5])[true] + drawn[0], drawn[1:])
    assert phases.count == 3
    np.testing.assert_array_equal(phases.labels, np.array([0, 2, 1])[true])


def test_a_seam_between_two_phases_is_no_phase_and_a_coat_is():
    for width, count in ((0.049, 2), (0.15, 3)):
        distance = np.abs(MESH.centres - 0.5).max(axis=1)
        field = np.where(distance < 0.2, 2.0, np.where(distance < 0.2 + width, 1.5, 1.0))
        assert find_phases(MESH, field).count == count


def test_a_gradual_stiffness_is_split_no_further_than_the_limit():
    assert find_phases(MESH, 1.0 + 3.0 * MESH.centres[:, 0]).count == MOST


def test_without_noise_a_contrast_of_a_hundredth_is_none_and_of_a_tenth_is_one():
    for contrast, wanted in ((0.01, NONE), (0.1, SEEN)):
        judged = score_phases(MESH, 1.0 + contrast * DISC, None, noisy=False)
        assert judged.summary["inclusion"] == wanted and judged.summary["contrast_needed"] == FLOOR
        np.testing.assert_array_equal(judged.variables["shape"], DISC & (wanted == SEEN))
        np.testing.assert_array_equal(judged.variables["phase_found"], DISC & (wanted == SEEN))


def test_the_unit_of_stress_does_not_matter():
    field, deviations = contrasted(0.3)
    one, other = (find_phases(MESH, unit * field, deviations) for unit in (1.0, 1e6))
    assert other.seen == pytest.approx(one.seen) and other.needed == one.needed
    np.testing.assert_array_equal(other.labels, one.labels)


def test_noise_without_samples_is_not_judged_and_the_sheet_is_split_in_two():
    field = contrasted(0.3)[0]
    judged = score_phases(MESH, field, None, noisy=True)
    assert judged.summary == {"inclusion": NOT_JUDGED} and judged.variables.keys() == {"shape"}
    np.testing.assert_array_equal(judged.variables["shape"], find_inclusion(MESH, field))


@pytest.fixture(scope="module")
def homogeneous():
    """Files of a run that identified a homogeneous sheet as it is."""
    nowhere = lambda X: np.zeros(len(X), bool)  # noqa: E731
    load = make_load("biaxial", [[1.05, 1.04], [1.1, 1.06]])
    return run_of(*sheet(8, nowhere, load, terms=TERMS))


def with_samples(files, spread):
    """The same with eight posterior samples whose stiffness scatters by this."""
    field, rng = files["constrained"], np.random.default_rng(0)
    samples = {
        name.replace("basis.", "posterior."): (("posterior_sample", *field[name].dims), np.stack(8 * [field[name]]))
        for name in field
        if name.startswith("basis.")
    }
    dims, level = samples["posterior.log_level"]
    samples["posterior.log_level"] = dims, level + spread * rng.normal(size=level.shape)
    return files | {"constrained": field.assign(samples)}


@pytest.mark.parametrize("with_inclusion", [True, False])
def test_a_run_that_finds_no_inclusion_has_no_second_curve_and_no_ratio(homogeneous, with_inclusion):
    truth = homogeneous["truth"]
    phase = with_inclusion * square(mesh_of(truth).centres).astype(int)
    judged = judge(homogeneous | {"truth": truth.assign(phase=("cell", phase))}, "biaxial", STRETCHES)
    assert judged.summary["inclusion"] == NONE and judged.summary["phases_found"] == 1
    assert judged.summary["dice"] == (0.0 if with_inclusion else 1.0)
    assert "inclusion_over_matrix" not in judged.summary and "curve_nrmse_inclusion" not in judged.summary
    assert judged.summary["curve_nrmse_matrix"] == 0.0 and not judged.variables["shape"].any()
    for name in ("curve_location", "curve_identified", "curve_true"):
        matrix, inclusion = judged.variables[name]
        assert np.isfinite(matrix).all() and np.isnan(inclusion).all()


def test_the_samples_of_a_run_say_which_contrast_it_could_have_seen(homogeneous):
    noisy = homogeneous | {"measurement": believed(homogeneous["measurement"], 1e-3)}
    del noisy["truth"]
    runs = [noisy, *(with_samples(noisy, spread) for spread in (0.1, 0.2))]
    unknown, *known = (judge(files, "biaxial", STRETCHES).summary for files in runs)
    assert unknown["inclusion"] == NOT_JUDGED and known[0]["inclusion"] == known[1]["inclusion"] == NONE
    needed = [summary["contrast_needed"] for summary in known]
    assert needed[0] > 2.0 * FLOOR and needed[1] == pytest.approx(2.0 * needed[0], rel=1e-6)
