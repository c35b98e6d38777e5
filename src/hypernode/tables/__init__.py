"""Tables of runs, times and settings, from opened result files only."""
