"""What identified laws make of another sheet: its forces and displacements, before or beside its own test."""
