"""What a test tells, read from an opened measurement: grid, displacement, noise, loading."""
