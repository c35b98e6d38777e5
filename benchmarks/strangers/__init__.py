"""An acceptance study: known sheets of other finite elements and laws than the project's, identified from files.

Usage: python -m benchmarks.strangers SEED [SEED ...]
"""
