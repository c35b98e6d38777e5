"""Pictures of a test: how they are made of a known one, and how points are followed through them."""
