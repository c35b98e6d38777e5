"""The material of a sheet as a function of position and deformation, and how it stands in a file."""
