"""What an identification believes of a sheet, its law and its measurement before data speak, and without them."""

import numpy as np

# What finite elements miss of displacements, over the largest of them: noise apart, these are trusted no further.
#: Of a field that was computed on the measured grid.
SAME_GRID_FLOOR = 3.8e-5
#: Of one that was observed, whose interfaces lie anywhere: times the number of cells along a side.
CUT_CELLS_FLOOR = 0.065
#: The same where cells are divided into subcells.
SUBCELLS_FLOOR = 0.01

# The record of the forces.
#: Share of a step's largest force below which a component's relative uncertainty no longer shrinks.
SMALLEST_FORCE = 0.1

# The homogeneous material.
#: How strongly the first fit prefers the plainest material, in units of a misfit of 1 %.
STRONG_RIDGE = 0.3
#: The same of the fit that sees what no material of the basis can follow.
WEAK_RIDGE = 0.03

# A field of cells.
#: Weight of the squared distance from the homogeneous fit, small: it decides only what data leave open.
RIDGE = 0.02
#: Relative jumps below this size are smoothed rather than counted.
SMALLEST_JUMP = 0.02
#: The same in the end where displacements have noise, which would hide in gentle slopes that cost nothing. On the
#: way so sharp a bend makes many local minima.
SHARP_JUMP = 0.005
#: What a jump of some further parameters counts, against one of the logarithm of the stiffness.
JUMP_SHARES = {"logit_dispersion": 0.3, "fibre_x": 4.0, "fibre_y": 4.0}
#: The same of all others.
DEFAULT_JUMP_SHARE = 0.5

# Whole cells of few materials.
#: What a side between two materials costs. The contour goes on or turns at its end: a digital straight line has no more
#: than two directions (Rosenfeld, Digital straight line segments, 1974).
CONTOUR_SIDE = float(np.log(2.0))

# Materials and lines, each by the inverse variance that it has without data, or by its usual size.
#: Of the logarithm of a stiffness: small.
LEVEL_HELD = 0.02
#: Of every other parameter: fibres and further terms are about as strong as the matrix.
LAW_HELD = 1.0
#: Of what a step changes of distances from lines.
DISTANCE_HELD = 3.0
#: Of the side of the window: none.
NOT_HELD = 1e-6
#: How near a line its distances bend, in sides of cells.
LINE_BENDS_WITHIN = 0.8
#: By how much they usually do, in sides of cells.
LINE_BEND = 0.3

# A material that changes gradually.
#: Cells of the measured grid between knots: what changes within fewer is no gradual change but a line.
CELLS_BETWEEN_KNOTS = 5
#: Usual second differences of neighbouring coefficients that are tried.
GRADUAL_BENDS = (0.2, 0.05, 0.0125)
#: Usual size of coefficients.
GRADUAL_SIZE = 2.0

# The window of the correlation and its noise.
#: Side of a window that nobody stated, in points: subsets overlap by half.
USUAL_WINDOW = 2.0
#: The same where its search begins.
FIRST_WINDOW = 1.5
#: Largest side of a window, in points.
LARGEST_WINDOW = 6.0
#: Share of what a window changes that its engine misses, where a search for it begins.
FIRST_SHARE = 0.1
#: The same at most, when the mean over the window says nothing of what is seen.
LARGEST_SHARE = 1.0
#: Distance in points up to which errors of neighbours are looked at: overlapping subsets share no more.
NOISE_REACH = 4
