"""Mechanics of one material point: kinematics, stress, closed forms, convex basis, loads, relaxation."""
