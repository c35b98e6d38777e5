"""Mechanics of one material point: kinematics, materials, stress."""
