"""An acceptance study: known sheets that share neither finite elements nor laws with the project, identified from files.

Usage: python -m benchmarks.strangers SEED [SEED ...]
"""
