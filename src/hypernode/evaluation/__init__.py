"""How good an identified material is, on one scale for every run."""
