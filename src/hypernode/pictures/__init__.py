"""Pictures of a sheet: the speckle on it, what a camera records of it, and what image correlation reads from them."""
