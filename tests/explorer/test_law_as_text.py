"""The text of every law gives the stress of the law itself."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hypernode.explorer.errors import ExplorerError
from hypernode.explorer.formulas import Formulas
from hypernode.explorer.tracing import trace
from hypernode.material.field import Material
from hypernode.material.files import material_of, posterior_material
from hypernode.material.laws import node_energy, node_stress
from hypernode.material.node_material import NodeMaterial
from hypernode.mechanics.closed_forms import MODELS
from hypernode.networks.potentials import POTENTIALS
from tests.evaluation.files import closed_form, square_mesh
from tests.explorer.decoding import called
from tests.explorer.files import constrained

#: A stretched and sheared state, and one whose fibres are slack.
STATES = np.array([[[1.2, 0.1], [-0.05, 1.1]], [[0.9, 0.02], [0.0, 1.05]]])
VALUES = {"kappa": 0.1, "k2": 1.5, "fibre_angle": 0.4, "K": 3.0}


def assert_same(material: Material, X, states=STATES):
    """The text at every position against the API."""
    stress, params = material.stress_law(X)
    law = called(trace(stress, jax.tree.map(lambda leaf: leaf[..., :1], params)).javascript)
    leaves = [np.asarray(leaf) for leaf in jax.tree.leaves(params)]
    for F in states:
        wanted = np.asarray(material.stress(X, np.broadcast_to(F, (len(X), 2, 2))))
        for k, P in enumerate(wanted):
            p = np.concatenate([np.ravel(leaf[..., k % leaf.shape[-1]]) for leaf in leaves])
            assert np.allclose(law(F, p), P, rtol=1e-6, atol=1e-9 * np.abs(P).max())


@pytest.mark.parametrize("model", MODELS)
def test_of_closed_forms(model):
    mesh = square_mesh(2)
    file = closed_form(mesh, model, **{name: VALUES.get(name, 0.7) for name in MODELS[model].parameters})
    assert_same(material_of(file), mesh.centres)


def test_of_a_basis_with_fibres_in_cells_of_several_parts():
    mesh = square_mesh(2)
    assert_same(material_of(constrained(mesh)), mesh.centres)


def test_of_posterior_samples_to_first_order():
    mesh = square_mesh(2)
    assert_same(posterior_material(constrained(mesh)), np.tile(mesh.centres, (4, 1)))


@pytest.mark.parametrize("potential", POTENTIALS)
def test_of_networks_of_every_kind(potential):
    # Fibres where the function is the neural ODE, and a compressible sheet for the others, which take less time.
    terms = ("I1", "I2", "I1_I4v", "I4v_I4w", "ogden_6") if potential == "node" else ("I1", "J")
    node = NodeMaterial(
        terms=terms, hidden=(3, 2), steps=2, invariant_scale=0.4, stress_scale=0.8, scaled=True, potential=potential
    )
    points = 2
    keys = jax.random.split(jax.random.key(1), points)
    params = jax.jit(jax.vmap(node.initial_params, out_axes=1))(keys)
    laws = partial(node_stress, node), partial(node_energy, node)
    assert_same(Material(lambda X: params, *laws, {}), np.zeros((points, 2)))


def test_a_law_that_has_no_text_is_refused_by_the_name_of_what_it_does():
    with pytest.raises(ExplorerError, match="'cumsum'"):
        trace(lambda F, p: jnp.cumsum(F, axis=0) * p, jnp.ones(1))


def test_equal_formulas_are_one_statement_and_numbers_are_calculated_at_once():
    formulas = Formulas()
    x, two = formulas.input("p[0]"), formulas.number(2.0)
    square = formulas.apply("mul", x, x)
    four = formulas.apply("mul", two, two)
    unused = formulas.apply("exp", x)
    total = formulas.apply("add", formulas.apply("mul", x, x), formulas.apply("add", four, formulas.number(0.0)))
    assert unused != total
    assert formulas.statements([total]) == (["a0=p[0]*p[0]", "a1=a0+4.0"], ["a1"])
    assert formulas.apply("mul", square, formulas.number(1.0)) == square


def test_a_number_below_zero_stands_in_brackets():
    formulas = Formulas()
    lines, _ = formulas.statements([formulas.apply("sub", formulas.input("p[0]"), formulas.number(-0.5))])
    assert lines == ["a0=p[0]-(-0.5)"]
