"""Stage 5: one set of neural-ODE parameters for the whole sheet."""

#: Weight of the squared neural-ODE weights and of the constants' departure from their start. The
#: homogenised fit has more parameters than data; this picks the plainest of the many that fit.
RIDGE_WEIGHTS, RIDGE_CONSTANTS = 1e-6, 1e-6
