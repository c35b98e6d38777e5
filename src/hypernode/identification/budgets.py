"""How many steps, rounds, probes, candidates, cells or bytes an identification spends at most."""

from hypernode.mechanics.convex_basis import PARAMETERS

# What a search tries.
#: Materials at most.
MOST_MATERIALS = 4
#: How often materials are sought again on top of another law.
SEARCH_ROUNDS = 2
#: How many of the terms that may join are tried, those first that promise most.
TERMS_TRIED = 2
#: How often a term may join at most: as many as there are.
MOST_TERMS = len(PARAMETERS)
#: A grid of more cells begins from the field of every second of its lines: so many take a minute, and show where
#: interfaces are. On finer grids a length of interface costs what it does here.
MOST_CELLS_AT_ONCE = 3600

# Steps of descents of materials and lines.
#: Where one begins near its end.
NEAR = 8
#: Where one begins far from it.
FAR = 15
#: Of lines that another law sends far from their place.
DISPLACED_LINES = 20
#: Of a law with J that leaves far more than the one without, which is then given up.
GIVEN_UP_AFTER = 3
#: Of materials of another volume: they begin near the kept ones.
OTHER_VOLUME_STEPS = 5
#: Of the last descent, which begins where the search ended.
ANSWER_STEPS = 20
#: How often samples of other laws may be brought nearer by half.
HALVED = 5

# A factor in every cell, and how it is cut.
#: Steps with total variation before larger jumps stop costing more.
CONVEX_FACTOR_STEPS = 4
#: Steps of blocks at most.
FACTOR_STEPS = 40
#: Further steps of cells near jumps.
CELL_FACTOR_STEPS = 10
#: Times that weights of jumps follow a step.
WEIGHT_ROUNDS = 2
#: Values that stand for all when levels are sought: their quantiles.
QUANTILES = 600
#: How often medians of several numbers are taken.
MEDIANS = 30

# Cells that change their material.
#: How often cells change.
OTHER_CELLS_ROUNDS = 10
#: Changes that are asked at most, so that their quadratic form takes seconds and a part of a gigabyte.
MOST_CHANGES = 4000
#: Random residuals, by which curvatures are known to a fifth.
PROBES = 64

# A field of cells.
#: How often what clamps do to a homogeneous sheet is computed anew.
BENDING_ROUNDS = 3
#: Iterations with total variation before jumps above the saturation size stop costing more.
CONVEX_STEPS = 5
#: Trials of a line search in the clipped direction.
CLIPPED_TRIALS = 2
#: The same in the whole direction.
SCALED_TRIALS = 5

# Equilibrium.
#: Newton steps to equilibrium, halves of them included.
EQUILIBRIUM_STEPS = 20
#: Newton steps for the jump of a laminate.
LAMINATE_STEPS = 30

# Linear solves and what is estimated by chance.
#: Conjugate-gradient iterations of a step, before and after jumps stop costing more.
CG_ITERATIONS = (150, 200)
#: The same of a posterior sample.
SAMPLE_ITERATIONS = 100
#: Random vectors that estimate the mean curvature of the data for the preconditioner.
CURVATURE_PROBES = 2
#: Vectors of random signs that count the directions of a step that is left out: they count ten to a tenth.
SIGNS = 16
#: Directions that a deflated solve keeps.
DEFLATED_DIRECTIONS = 40

# Memory.
#: Memory of the directions and products that a solve remembers [bytes]. 200 of 100 x 100 cells take as much; of more
#: cells, the worst of them take the place of all.
REMEMBERED = 384 * 2**20
#: Memory of what is copied of them at a time [bytes]: all of 50 x 50 cells.
COPIED = 64 * 2**20
#: Errors of prescribed edges that are followed through the sheet at a time: all of 50 x 50 cells. Displacements of all
#: at once would be the largest array of a large grid.
ERRORS_AT_ONCE = 256
