"""Names, units and meaning of every variable and dimension that the project stores."""

from dataclasses import dataclass

import xarray as xr

#: Version of the names and dimensions below. A file of another version is refused: a variable of the same name may mean
#: something else in it.
SCHEMA_VERSION = 6
#: Variables that only a synthetic case has, because only there the truth is known.
TRUTH = ("u_truth", "F_truth", "phase")
#: Dimension -> what one index along it is.
DIMS = {
    "load_step": "one equilibrium state; the steps of several tests follow one another",
    "test": "one test of a specimen, in the order of its load cases",
    "repeat": "one measurement of the same test",
    "frame": "one picture of the sheet: at rest, then of each load step",
    "row": "a row of pixels, from the top",
    "column": "a column of pixels, from the left",
    "disc": "one dark disc of the speckle",
    "pixel_point": "a point of the reference picture that is followed through the others",
    "grey_node": "a node of the elements on which grey levels are compared",
    "grey_cell": "one of these elements",
    "element_dof": "displacement of a vertex of an element, x then y, vertex by vertex",
    "other_dof": "the same",
    "component": "along columns, to the right, then along rows, downward",
    "record_sample": "one of equal times of the force record",
    "open_sample": "a field of a law that explains the test as well",
    "node": "a grid point where displacement is measured or computed",
    "cell": "a quadrilateral of four neighbouring grid points",
    "vertex": "the four nodes of a cell, counter-clockwise from the lower left",
    "quadrature_point": "a 2 x 2 Gauss point of a cell",
    "edge": "left, right, bottom, top",
    "interface": "the line around each material but the first",
    "i": "spatial component, x then y",
    "J": "material component, X then Y",
    "parameter": "one weight of the neural ODEs",
    "phase_index": "one phase of the true material",
    "iteration": "optimiser step at which the loss was recorded",
    "mode": "prescribed homogeneous deformation used to judge",
    "stretch_index": "stretch at which a mode is judged",
    "curve_point": "sample along a stress-stretch curve",
    "location": "point of the sheet at which a curve is drawn",
    "corner": "lower left, then upper right",
    "deformation_measure": "one measure of how a point is deformed, named in the attribute deformation_measures",
    "bound": "the smallest value, then the largest",
    "sheet": "one sheet of a population, by name; fields of a collection have it before their own dimensions",
}


@dataclass(frozen=True)
class Variable:
    """How a stored variable is described.

    ``unit`` is a literal unit, or one of the words ``length``, ``stress``, ``force`` and ``energy``, or a power of it
    as ``length^-2``. Each file replaces a word by its own unit (synthetic tests: 1, Pa; experiments: mm, MPa, N).
    """

    dims: tuple[str, ...]
    unit: str
    long_name: str


_FIELD = ("load_step", "cell", "quadrature_point")
_TENSOR = ("load_step", "cell", "i", "J")
#: Every stored variable. A file may hold any subset of them; weights of networks are named
#: ``<network>.<path>`` and carry dimensions of their own.
VARIABLES = {
    # grid
    "X": Variable(("node", "i"), "length", "reference position of the nodes"),
    "cells": Variable(("cell", "vertex"), "1", "node numbers of each cell"),
    "corners": Variable(("corner", "i"), "length", "bounding rectangle of the sheet"),
    "relative_thickness": Variable(("cell",), "1", "thickness over that of the sheet, the attribute thickness"),
    "phase": Variable(("cell",), "1", "index of the material phase, -1 unknown"),
    "model": Variable(("cell",), "1", "index of the material model in the attribute models"),
    # loading
    "load_case": Variable(("load_step",), "1", "load case of each step"),
    "stretch": Variable(("load_step",), "1", "edge stretch that names the step"),
    "H": Variable(("load_step", "i", "J"), "1", "displacement gradient of the bounding rectangle"),
    "time": Variable(("load_step",), "s", "time in the clock of the force record"),
    "edge_force": Variable(
        ("load_step", "edge", "i"), "force", "outward resultant on each edge; NaN where not measured"
    ),
    "nodal_force": Variable(("load_step", "node", "i"), "force", "outward force on each node of the computed outline"),
    "relaxation": Variable(
        ("load_step",), "1", "recorded force over that of an elastic sheet as stiff as this one at the test's pace"
    ),
    "relaxation_time": Variable(("test", "record_sample"), "s", "times at which the relaxation of the record is known"),
    "relaxation_factor": Variable(
        ("test", "record_sample"), "1", "recorded force over that of the relaxed elastic sheet at those times"
    ),
    "edge_constrained": Variable(
        ("load_step", "edge", "i"), "1", "1 where the edge displacement is prescribed, 0 where it is free"
    ),
    "newton_residual": Variable(("load_step",), "1", "free residual over reaction norm at convergence"),
    # pictures
    "disc_centre": Variable(("disc", "i"), "length", "centre of a disc on the sheet at rest"),
    "disc_radius": Variable(("disc",), "length", "its radius"),
    "picture": Variable(("frame", "row", "column"), "1", "grey level"),
    "on_sheet": Variable(("row", "column"), "1", "1 where the centre of a pixel sees the sheet at rest"),
    "pixel_column": Variable(("pixel_point",), "1", "pixel of a followed point in the reference picture"),
    "pixel_row": Variable(("pixel_point",), "1", "the same, from the top"),
    "pixel_displacement": Variable(
        ("frame", "pixel_point", "component"), "1", "displacement in pixels, NaN where the point is lost"
    ),
    "correlation": Variable(
        ("frame", "pixel_point"), "1", "zero-normalised cross-correlation of the compared subsets, 1 at best"
    ),
    "grey_X": Variable(("grey_node", "i"), "length", "nodes of the elements on which grey levels are compared"),
    "grey_cells": Variable(("grey_cell", "vertex"), "1", "node numbers of each of these elements"),
    "grey_u": Variable(("load_step", "grey_node", "i"), "length", "displacement at which grey levels are linearised"),
    "grey_information": Variable(
        ("load_step", "grey_cell", "element_dof", "other_dof"),
        "length^-2",
        "second derivative, by the displacement of an element's nodes, of half of the squared differences of grey "
        "levels over their variance",
    ),
    "grey_pull": Variable(
        ("load_step", "grey_cell", "element_dof"), "length^-1", "minus the first derivative of the same, at grey_u"
    ),
    # fields
    "u": Variable(("load_step", "node", "i"), "length", "displacement"),
    "u_measured": Variable(("repeat", "load_step", "node", "i"), "length", "measured displacement"),
    "force_pairing_uncertainty": Variable(("load_step",), "1", "uncertainty of a force by its picture, over its size"),
    "force_relaxation_uncertainty": Variable(("load_step",), "1", "the same by what of it is a matter of time"),
    "noise_scatter": Variable(("load_step", "i"), "length", "standard deviation of a measured displacement"),
    "noise_level": Variable(("load_step", "i"), "length", "that of independent errors that weigh as much as these"),
    "frames_noise_scatter": Variable(
        ("load_step", "i"), "length", "noise_scatter as the frames tell it where another is stated"
    ),
    "frames_noise_level": Variable(("load_step", "i"), "length", "noise_level as the frames tell it, likewise"),
    "camera_angle": Variable(("load_step",), "degree", "angle of the camera since the reference, which was taken out"),
    "u_truth": Variable(("load_step", "node", "i"), "length", "displacement without noise"),
    "X_quadrature": Variable(("cell", "quadrature_point", "i"), "length", "quadrature points"),
    "F": Variable(_TENSOR, "1", "deformation gradient at the cell centres"),
    "F_quadrature": Variable((*_FIELD, "i", "J"), "1", "deformation gradient at the quadrature points"),
    "P_quadrature": Variable((*_FIELD, "i", "J"), "stress", "first Piola-Kirchhoff stress at the quadrature points"),
    "F_truth": Variable(_TENSOR, "1", "deformation gradient without noise, at the cell centres"),
    "F_interpolated": Variable(_TENSOR, "1", "deformation gradient of the interpolant, at the cell centres"),
    "snr": Variable(("load_step",), "1", "signal-to-noise ratio in decibels of F, equation eq:SNR of the paper"),
    "snr_measured": Variable(("load_step",), "1", "signal-to-noise ratio in decibels of F, differentiated measurement"),
    "snr_smoothed": Variable(("load_step",), "1", "signal-to-noise ratio in decibels of F after the gradient stage"),
    "snr_used": Variable(("load_step",), "1", "signal-to-noise ratio in decibels of F as the training sees it"),
    "anisotropy": Variable(("cell",), "1", "identified difference over sum of principal P, equibiaxial"),
    "anisotropy_true": Variable(("cell",), "1", "true difference over sum of principal P, equibiaxial"),
    "fibre_angle": Variable(("cell",), "degree", "identified stiffest direction from x"),
    "fibre_angle_true": Variable(("cell",), "degree", "true stiffest direction from x"),
    "t": Variable(("load_step",), "1", "load parameter of the interpolant, 1 at the last step of a test"),
    "amplitude": Variable(("load_step",), "1", "root mean square of F - I"),
    "gradient_variance": Variable(
        ("cell",), "1", "variance of F in a cell over the mean one, of an interpolant from its misfit there"
    ),
    "misfit": Variable(("load_step",), "1", "relative L2 misfit of the interpolant, of F - I"),
    # training
    "loss": Variable(("iteration",), "1", "training loss"),
    "loss_iteration": Variable(("iteration",), "1", "optimiser step of each recorded loss"),
    "material_label": Variable(("cell",), "1", "material that has most of a cell, from 0"),
    "interface_distance": Variable(("interface", "node"), "1", "sides of a cell from a line, positive in its material"),
    "local_misfit": Variable(("cell",), "1", "misfit around a cell over that of the sheet or noise, what is more"),
    "unexplained": Variable(("cell",), "1", "1 where that is more than chance makes anywhere in a sheet"),
    "residual": Variable(("load_step", "node", "i"), "1", "misfit of a displacement over its expected error"),
    "P_jump": Variable(("load_step", "cell", "i", "J"), "stress", "P of a cut cell less that of the law at its centre"),
    "node_params": Variable(("parameter",), "1", "homogenised parameters of the neural ODEs"),
    "P_average": Variable(("load_step", "i", "J"), "stress", "force over cross-section"),
    "P_homogenised": Variable(("load_step", "i", "J"), "stress", "homogenised stress at the mean F"),
    "deformation_seen": Variable(
        ("deformation_measure", "bound"),
        "1",
        "range of each measure of deformation over the test; beyond it the material is extrapolated",
    ),
    "held_out": Variable(("load_step",), "1", "1 for steps that judge a polished network, which did not see them"),
    # evaluation; the measured deformation is the differentiated mean of the repeats, the identified one the field that
    # the method uses: its equilibrium field, its interpolant, or what the gradient stage made of the measurement
    "mode_F": Variable(("mode", "stretch_index", "i", "J"), "1", "prescribed common deformation gradient"),
    "stress_error": Variable(("mode", "stretch_index"), "1", "relative L2 error of P at common F"),
    "stress_error_phase": Variable(
        ("phase_index", "mode", "stretch_index"), "1", "relative L2 error of P at common F by phase"
    ),
    "P_identified": Variable(("mode", "stretch_index", "cell", "i", "J"), "stress", "identified P at common F"),
    "P_true": Variable(("mode", "stretch_index", "cell", "i", "J"), "stress", "true P at common F"),
    "trace_P": Variable(("cell",), "stress", "indicator field from which the shape is read"),
    "trace_P_spread": Variable(("cell",), "stress", "its standard deviation, by samples and in cut cells"),
    "refuted_by": Variable(("cell",), "1", "what is missed and grows with the test, over noise; zero by chance"),
    "refuted": Variable(("cell",), "1", "1 where that stands for deformation that counts for a stress"),
    "shape": Variable(("cell",), "1", "cells found to belong to the inclusion"),
    "phase_found": Variable(("cell",), "1", "number of the distinguishable phase of each cell, from the softest"),
    "shape_true": Variable(("cell",), "1", "cells that belong to the inclusion"),
    "curve_stretch": Variable(("curve_point",), "1", "stretch along the curves"),
    "curve_identified": Variable(("location", "curve_point", "i"), "stress", "identified normal P_xX and P_yY"),
    "curve_true": Variable(("location", "curve_point", "i"), "stress", "true normal stresses P_xX and P_yY"),
    "curve_location": Variable(("location", "i"), "length", "where the curves are drawn, NaN without an inclusion"),
    "edge_force_identified": Variable(
        ("load_step", "edge", "i"), "force", "edge resultant of the sheet that is computed with the identified material"
    ),
    "edge_force_predicted": Variable(("load_step", "edge", "i"), "force", "resultant by laws of other sheets"),
    "edge_force_spread": Variable(("load_step", "edge", "i"), "force", "its standard deviation"),
    "u_spread": Variable(("load_step", "node", "i"), "length", "standard deviation of a predicted displacement"),
    "edge_force_at_measured": Variable(
        ("load_step", "edge", "i"), "force", "edge resultant of the identified stress at the measured deformation"
    ),
    "edge_force_error_measured": Variable(
        ("load_step",), "1", "largest relative error of a measured resultant at the measured deformation"
    ),
    "equilibrium_residual_measured": Variable(
        ("load_step",), "1", "nodal residual norm over the norm of the nodal cell forces, at the measured deformation"
    ),
    "equilibrium_gap_measured": Variable(
        ("load_step",), "1", "relative distance of P from the nearest equilibrated stress at the measured deformation"
    ),
    "principal_strain_measured": Variable(
        ("load_step", "cell"), "1", "largest principal Green-Lagrange strain of the measured deformation"
    ),
    "edge_force_at_identified": Variable(
        ("load_step", "edge", "i"), "force", "edge resultant of the identified stress at the identified deformation"
    ),
    "edge_force_error_identified": Variable(
        ("load_step",), "1", "largest relative error of a measured resultant at the identified deformation"
    ),
    "equilibrium_residual_identified": Variable(
        ("load_step",), "1", "nodal residual norm over the norm of the nodal cell forces, at the identified deformation"
    ),
    "equilibrium_gap_identified": Variable(
        ("load_step",),
        "1",
        "relative distance of P from the nearest equilibrated stress at the identified deformation",
    ),
    "principal_strain_identified": Variable(
        ("load_step", "cell"), "1", "largest principal Green-Lagrange strain of the identified deformation"
    ),
    # collections of populations
    "case": Variable(("sheet",), "1", "name of the sheet"),
    "method": Variable(("sheet",), "1", "method that identified it"),
    "geometry": Variable(("sheet",), "1", "geometry of its inclusion"),
    "inclusion": Variable(("sheet",), "1", "material inside"),
    "matrix": Variable(("sheet",), "1", "material outside"),
    "noise": Variable(("sheet",), "1", "measurement error, with its seed where there are several"),
    "seed": Variable(("sheet",), "1", "seed of that error"),
    "verdict": Variable(("sheet",), "1", "verdict on the sheet, with the criteria to blame"),
    "level": Variable(("sheet",), "1", "overall level of the verdict"),
    "digest": Variable(("sheet",), "1", "SHA-256 of the file of the sheet"),
    "P_field": Variable(
        ("load_step", "cell", "i", "J"), "stress", "identified P at the identified deformation, at the cell centres"
    ),
}


def without_truth(dataset: xr.Dataset) -> xr.Dataset:
    """A dataset without what no test could measure: all that an identification may see."""
    return dataset.drop_vars([name for name in TRUTH if name in dataset])
