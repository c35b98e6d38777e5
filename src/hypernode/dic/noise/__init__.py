"""The noise of measured displacements, from the displacements themselves."""
