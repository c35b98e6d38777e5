"""Networks: Fourier-feature perceptron, neural ODEs, the potentials they form. Pure functions."""
