"""Figures, drawn from opened result files only."""
