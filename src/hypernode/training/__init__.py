"""Networks fitted to a field: the loop, the losses, the targets."""
