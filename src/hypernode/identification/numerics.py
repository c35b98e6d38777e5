"""Tolerances, steps, damping and differences of the numerical methods. None of them should change an answer."""

import numpy as np

# Equilibrium.
#: Relative residual at which Newton's method ends, far below what displacements are trusted to.
NEWTON_TOLERANCE = 1e-6
#: Share of the residual that a step with old factors may leave before new ones are made.
SLOW = 0.1
#: Share of the tolerance that the last step with old factors may leave.
WITH_OLD_FACTORS = 0.1
#: Part of the way to another load step that is followed at once, at least.
SHORTEST_WAY = 1.0 / 32.0
#: Of weights that sum to one.
ROUNDING = 1e-9

# Cells with two materials.
#: Change of the jump of a laminate that ends its steps: the next one would be about its square.
LAMINATE_TOLERANCE = 1e-6
#: Share of the way to where a side would have no area that a step goes at most.
LAMINATE_NEAREST = 0.8
#: Share of a cell below which a layer of it is none.
SMALLEST_LAYER = 1e-8

# Where fits begin.
#: First guess of the neo-Hookean coefficient, over the largest mean stress: that of a stretch of about a third.
FIRST_LEVEL = 0.3
#: Length of the fibre vector from which it can grow: at zero it has no gradient.
SMALLEST_FIBRE = 0.01
#: Parameter of a coefficient that is none: a fiftieth of what is left of it at the bound of a search.
ABSENT = float(np.log1p(-0.99))

# Steps of every descent.
#: Largest change of a parameter in one step: twice as stiff and more is beyond what a linearisation tells.
LARGEST_STEP = 1.0
#: Factor between trials of a line search.
SEARCH_FACTOR = 0.4

# Descents of a field of cells.
#: First step tried once jumps stop costing more: a step minimises a quadratic above the penalty, and falls short.
OVER_RELAXATION = 1.7
#: Where the damping begins.
FIRST_DAMPING = 1.0
#: Its lower bound.
SMALLEST_DAMPING = 1e-4
#: Its upper bound, where a descent ends.
LARGEST_DAMPING = 1e6
#: Factor of the damping after a whole step.
DAMPING_AFTER_SUCCESS = 0.25
#: The same after a short one.
DAMPING_AFTER_SHORT_STEP = 4.0
#: The same after none.
DAMPING_AFTER_FAILURE = 100.0
#: Fraction of a step from which it counts as whole.
WHOLE_STEP = 0.99
#: Fraction below which it counts as short.
SHORT_STEP = 0.5

# Conjugate gradients.
#: Residual at which they end, relative to the gradient: while the displacements are not explained, and then. On
#: the way valleys are narrow: loose steps cross them to and fro, and where that ends is chance.
CG_TOLERANCE = (0.001, 0.003)
#: Share of the mean curvature of the data that joins the preconditioner.
CURVATURE_SHARE = 0.3
#: Directions whose curvature is below this share of the largest, after scaling, say the same as others.
REDUNDANT = 1e-8
#: Relative residual of a posterior sample.
SAMPLE_TOLERANCE = 0.01
#: Relative residual of the one that counts effective parameters, which are then missed by less than their chance.
TRACE_TOLERANCE = 0.03
#: Variance that errors of prescribed edges add to a combination of residuals, over its own, below which it is left out.
NEGLIGIBLE_VARIANCE = 1e-2

# Descents of a factor in every cell.
#: Cells along a side of the blocks that share numbers at first, and then.
BLOCKS = (4, 2)
#: Fractions of a step that are tried.
FACTOR_FRACTIONS = (1.0, 0.5, 0.2, 0.05)
#: A step that gains less than this share of the cost ends the descent.
FACTOR_GAIN = 5e-3

# Descents of materials and lines.
#: Levenberg and Marquardt: shares of the curvature that are added until a step lowers the cost.
DAMPING_SHARES = (0.0, 0.01, 0.1, 1.0, 10.0)
#: What a step gains that ends a descent.
DESCENT_GAIN = 0.5
#: The same over the cost, or over that of noise where this is more.
RELATIVE_DESCENT_GAIN = 1e-3
#: Share of what a step promises that it must gain, so that the next one may be made of the same derivatives.
TRUSTED = 0.7
#: Distance from a line, in sides of cells, within which it may change: corners of the cells that it cuts.
LINE_REACH = 1.3
#: Steps before which distances are measured anew, so that their slope stays one.
MEASURED_ANEW = (2, 5)
#: How many steps there are at least where distances are measured anew.
SETTLED = 6
#: Half of the difference of two windows, in points, that stands for a derivative.
WINDOW_DIFFERENCE = 0.05
#: Share of a level that a straight step leaves at least; a longer one is taken in its logarithm.
LEVEL_LEFT = 0.25
#: Level over the one before below which the linear model says nothing of it.
LEAST_LEVEL = 0.1
#: Parameters of J, beside fibres, where a descent begins: nearly those of a kept volume, 0 and log 2. At zero a
#: coefficient has no slope.
NEARLY_KEPT = {"log1p_J_area": 0.05, "log1p_J_volume": 0.69}

# Finer elements and lines.
#: Rows and columns into which a cell is divided for the answer.
FINER = 2
#: Distance between points of a line, in sides of cells, where more than noise is left.
CLOSER_POINTS = 0.5

# Cells that change their material.
#: Part of a change up to which it promises nothing, were it real.
PROMISED_PART = 0.05
#: How far a piece begins to reach from the centre of its cell, in sides of cells: just beyond the corners.
PIECE_REACH = 0.8
