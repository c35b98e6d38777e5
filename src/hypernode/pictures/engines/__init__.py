"""Scripts that the Pythons of the correlation engines execute, each in an environment without this package."""
