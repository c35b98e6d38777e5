"""Finite elements: meshes, equilibrium, nodal forces. Discrete; knows no data."""
