"""Tests of the 2025 Mechanical MNIST Challenge: what a file holds, which class a point has, and its score."""
