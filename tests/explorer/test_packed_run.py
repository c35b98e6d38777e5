"""What the page has of a run agrees with the run: its material everywhere, its spread, its numbers."""

import json

import numpy as np
import pytest

from hypernode.evaluation.probes import equibiaxial_stress
from hypernode.evaluation.spread import sample_spread
from hypernode.explorer.forces import sheets_of_one_phase
from hypernode.explorer.laws import SPREAD_ERROR, STRESS_ERROR, probes
from hypernode.explorer.packing import Arrays
from hypernode.explorer.run import packed_run
from hypernode.fem.mesh import EDGE_NAMES
from hypernode.material.files import material_of, posterior_material
from tests.evaluation.files import square_mesh
from tests.explorer.decoding import called, decoded, params_at
from tests.explorer.files import SAMPLES, run_files

#: The page's promise.
AGREEMENT = 0.01
CELLS = 4


@pytest.fixture(scope="module")
def files():
    return run_files(CELLS, "fail")


@pytest.fixture(scope="module")
def packed(files):
    arrays = Arrays()
    return packed_run(files, arrays), arrays


@pytest.mark.parametrize(("name", "file"), [("identified", "material"), ("truth", "truth")])
def test_the_stress_of_every_cell_is_that_of_the_material(files, packed, name, file):
    run, arrays = packed
    mesh, material = square_mesh(CELLS), material_of(files[file])
    law = called(run[name]["law"])
    states = probes(1.25)[::3]
    wanted = np.asarray(material.stress(mesh.centres, np.broadcast_to(states[:, None], (len(states), 16, 2, 2))))
    for cell in range(16):
        p = params_at(run[name], arrays, cell)
        error = np.linalg.norm([law(F, p) - P for F, P in zip(states, wanted[:, cell], strict=True)], axis=(1, 2))
        assert (error <= STRESS_ERROR * np.linalg.norm(wanted[:, cell], axis=(1, 2))).all()
    assert STRESS_ERROR <= AGREEMENT / 5


def test_the_true_material_is_kept_exactly(files, packed):
    run, arrays = packed
    found = np.array([params_at(run["truth"], arrays, cell) for cell in range(16)])
    stored = {
        name: files["truth"][f"material.{name}"].values for name in ("C10", "fibre_angle", "k1", "k2", "kappa", "model")
    }
    # Leaves of a dictionary stand in the order of their names.
    assert np.array_equal(found, np.stack([stored[name] for name in sorted(stored)], axis=1))


def test_the_spread_is_that_of_the_posterior_samples(files, packed):
    run, arrays = packed
    mesh, posterior = square_mesh(CELLS), posterior_material(files["constrained"])
    at_all = equibiaxial_stress(posterior, np.tile(mesh.centres, (SAMPLES, 1)), [1.1])[0]
    wanted = sample_spread(np.trace(at_all, axis1=1, axis2=2).reshape(SAMPLES, -1))
    law, changes = called(run["posterior"]["law"]), decoded(run["posterior"]["changes"], arrays)
    for cell in (0, 7, 15):
        best = params_at(run["posterior"], arrays, cell)
        drawn = [law(1.1 * np.eye(2), np.append(best, changes[:, s, cell])) for s in range(SAMPLES)]
        assert np.trace(drawn, axis1=1, axis2=2).std(ddof=1) == pytest.approx(wanted[cell], rel=SPREAD_ERROR)


def test_a_run_without_noise_or_field_has_no_spread_and_no_misfit(files):
    without = {key: files[key] for key in ("evaluation", "measurement")} | {"material": files["truth"]}
    run = packed_run(without, Arrays())
    assert run["posterior"] is None and "misfit" not in {each["key"] for each in run["maps"]}


def test_the_worst_criterion_is_said_first(packed):
    verdict = packed[0]["verdict"]
    assert verdict["level"] == "fail"
    assert [each["level"] for each in verdict["criteria"]] == ["fail", "fail", "pass"]


def test_forces_are_listed_where_they_are_measured_with_their_error(packed):
    run, _ = packed
    assert {row["name"] for row in run["forces"]} == {"fx, right edge", "fx, top edge", "fy, top edge"}
    assert all(row["error"] == pytest.approx(2.0) for row in run["forces"])
    assert [row["step"] for row in run["forces"]] == [0, 0, 0, 1, 1, 1, 2, 2, 2]


def test_sheets_of_one_phase_become_nominal_stresses(files):
    sheet = files["measurement"].assign(relaxation=0.5 + 0.0 * files["measurement"]["relaxation"])
    sheet = sheet.assign_attrs(thickness=2.0)
    steps, top = 3, EDGE_NAMES.index("top")
    force = np.zeros((steps, 4, 2))
    force[:, top, 1] = [1.0, 2.0, 3.0]
    references = files["measurement"][["edge_force"]].assign(
        edge_force_identified=(("load_step", "edge", "i"), force),
        load_case=("load_step", np.zeros(steps, int)),
        stretch=("load_step", np.array([1.05, 1.1, 1.15])),
    )
    references = references.assign_attrs(load="clamped_y", load_cases=json.dumps(["matrix: soft"]))
    (found,) = sheets_of_one_phase({"references": references, "sheet_matrix": sheet})
    assert (found["phase"], found["name"], found["axis"], found["clamped"]) == ("matrix", "soft", 1, True)
    # Force over relaxation and section, of unit width.
    assert found["computed"] == pytest.approx([1.0, 2.0, 3.0])
    assert found["measured"] == pytest.approx(files["measurement"]["edge_force"].values[:, top, 1])
