"""Networks: Fourier-feature perceptron, neural ODEs, the material they form."""
