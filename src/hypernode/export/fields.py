"""The fields of a run that other programs show: stiffness, parameters, spread, fibres, phases and verdict."""

import json
from typing import NamedTuple

import jax
import numpy as np
from jaxtyping import Float

from hypernode.evaluation.probes import equibiaxial_stress, preferred_direction
from hypernode.evaluation.spread import sample_spread
from hypernode.export.run import Run
from hypernode.material.basis_file import basis_field
from hypernode.material.field import Material

#: Equibiaxial stretch at which moduli are those of a sheet that hardly deforms and whose fibres are taut already: below
#: one they bear nothing, and at one a derivative has no side.
TAUT = 1.001
#: Letters of the convex basis that are stresses, and those of the fibres' direction, which is a field of its own.
STRESSES, DIRECTION = ("c",), ("rx", "ry")


class Field(NamedTuple):
    """Values by cell or by node, (cell,), (cell, 3) or (node, 3), with their unit and meaning."""

    values: np.ndarray
    unit: str
    meaning: str


def stiffness(
    material: Material, X: Float[np.ndarray, "point 2"], stretch: float, plane: str = "stress"
) -> dict[str, np.ndarray]:
    """Measures of stiffness at positions: the trace of P at an equibiaxial stretch, and moduli of the taut sheet.

    A small pull with free sides gives a modulus E' and a contraction nu'. In plane stress these are E and nu. In plane
    strain nu = nu' / (1 + nu') and E = E' (1 - nu^2).

    Args:
        plane: ``stress`` or ``strain``.
    """
    P = equibiaxial_stress(material, X, [stretch])[0]
    A = np.asarray(material.tangent(X, np.broadcast_to(TAUT * np.eye(2), (len(X), 2, 2))), float)
    xx, yy, xy, shear = A[:, 0, 0, 0, 0], A[:, 1, 1, 1, 1], A[:, 0, 0, 1, 1], A[:, 0, 1, 0, 1]
    return {
        "trace_P": P[:, 0, 0] + P[:, 1, 1],
        "modulus_xx": xx,
        "modulus_yy": yy,
        "modulus_xy": xy,
        "modulus_shear": shear,
        **_engineering(xx, yy, xy, plane),
    }


def _engineering(xx, yy, xy, plane: str) -> dict[str, np.ndarray]:
    """E and nu of small pulls along either axis, by their name."""
    found = {}
    for axis, along, across in (("x", xx, yy), ("y", yy, xx)):
        young, poisson = along - xy**2 / across, xy / across
        if plane == "strain":
            poisson = poisson / (1.0 + poisson)
            young = young * (1.0 - poisson**2)
        found |= {f"young_{axis}": young, f"poisson_{axis}": poisson}
    return found


def cell_fields(run: Run) -> dict[str, Field]:
    """{name: field} by cell."""
    stretch, unit = float(run.files["evaluation"].attrs["shape_stretch"]), run.material.units["stress"]
    plane = run.plane
    meanings = {
        "trace_P": f"P_xX + P_yY at an equibiaxial stretch of {stretch:.4g}",
        "modulus_xx": f"dP_xX/dF_xX at an equibiaxial stretch of {TAUT}, where fibres are taut",
        "modulus_yy": "dP_yY/dF_yY there",
        "modulus_xy": "dP_xX/dF_yY there",
        "modulus_shear": "dP_xY/dF_xY there",
        "young_x": f"Young's modulus of a small pull along x, in plane {plane}",
        "young_y": f"Young's modulus of a small pull along y, in plane {plane}",
        "poisson_x": f"Poisson's ratio of a small pull along x, in plane {plane}",
        "poisson_y": f"Poisson's ratio of a small pull along y, in plane {plane}",
    }
    units = {name: "1" if name.startswith("poisson") else unit for name in meanings}
    found = stiffness(run.material, run.mesh.centres, stretch, plane)
    fields = {name: Field(found[name], units[name], meaning) for name, meaning in meanings.items()}
    if run.posterior is not None:
        samples = stiffness(run.posterior, run.sample_positions, stretch, plane)
        for name in meanings:
            spread = sample_spread(samples[name].reshape(run.samples, -1))
            about = f"standard deviation of {name} over the posterior samples"
            fields[f"{name}_spread"] = Field(spread, units[name], about)
    return fields | _fibres(run, stretch) | _parameters(run) | _findings(run)


def _fibres(run: Run, stretch: float) -> dict[str, Field]:
    anisotropy, degrees = preferred_direction(run.material, run.mesh.centres, stretch)
    angle = np.deg2rad(degrees)
    direction = anisotropy[:, None] * np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)
    return {
        "anisotropy": Field(anisotropy, "1", f"difference over sum of principal P, equibiaxial stretch {stretch:.4g}"),
        "fibre": Field(direction, "1", "stiffest direction, as long as the anisotropy"),
    }


def _parameters(run: Run) -> dict[str, Field]:
    """Parameters of a closed form or of the basis: where networks hold the material, of the field that taught them."""
    file = run.files["material"]
    if file.attrs["material_kind"] == "closed_form":
        return {
            name: Field(file[name].values, "as in its law", "parameter")
            for name in file
            if name.startswith("material.")
        }
    file = run.files.get("constrained", file if file.attrs["material_kind"] == "convex_basis" else None)
    if file is None:
        return {}
    basis, best = basis_field(file)
    coefficients = basis.coefficients(best)
    changes = {}
    if f"posterior.{basis.names[0]}" in file:
        drawn = np.stack([file[f"posterior.{name}"].values for name in basis.names])
        start = np.broadcast_to(best[:, None], drawn.shape)
        # To first order, as the samples themselves are.
        _, changes = jax.jvp(basis.coefficients, (start,), (drawn - start,))
    fields = {}
    for letter in [each for each in coefficients if each not in DIRECTION]:
        unit, name = run.material.units["stress"] if letter in STRESSES else "1", f"basis_{letter}"
        about = f"coefficient {letter} of the convex basis, mean of the subcells"
        fields[name] = Field(np.asarray(coefficients[letter]).mean(axis=0), unit, about)
        if changes:
            spread = sample_spread(np.asarray(changes[letter]).mean(axis=1))
            fields[f"{name}_spread"] = Field(spread, unit, f"standard deviation of {name} over the posterior samples")
    return fields


def _findings(run: Run) -> dict[str, Field]:
    level, evaluation, unit = run.verdict.overall, run.files["evaluation"], run.material.units["stress"]
    shape = evaluation["shape"].values
    read_from = {"indicator": Field(evaluation["trace_P"].values, unit, "stress from which phases and shape were read")}
    if "trace_P_spread" in evaluation:
        about = "standard deviation of indicator over the posterior samples"
        read_from["indicator_spread"] = Field(evaluation["trace_P_spread"].values, unit, about)
    return read_from | {
        "phase": Field(run.phase, "1", "phase, from the softest"),
        "inclusion": Field(shape, "1", "1 where a cell belongs to the inclusion"),
        "thickness": Field(run.thickness, run.material.units["length"], "thickness"),
        "verdict": Field(np.full(len(shape), level.rank), "1", "of the run: 1 pass, 2 warn, 3 fail; 0 not judged"),
    }


def point_fields(run: Run) -> dict[str, Field]:
    """{name: field} by node: the displacement of every load step, from 1."""
    evaluation, u = run.files["evaluation"], run.displacement
    stretches = evaluation["stretch"].values
    kind = "identified" if "constrained" in run.files else "measured"
    cases = run.files["measurement"]["load_case"].values
    names = json.loads(run.files["measurement"].attrs.get("load_cases", "null")) or [evaluation.attrs["load"]]
    return {
        f"displacement_{step + 1}": Field(
            np.pad(field, ((0, 0), (0, 1))),
            run.material.units["length"],
            f"{kind} displacement, {names[min(cases[step], len(names) - 1)]}, stretch {stretches[step]:.4g}",
        )
        for step, field in enumerate(u)
    }
