"""The inverse problem: the material field under which equilibrium explains a test."""
