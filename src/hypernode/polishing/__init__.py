"""A hyper-network whose own finite-element equilibrium explains the test: its weights under the constraint."""
