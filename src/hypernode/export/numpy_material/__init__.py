"""The sections that an exported Python file is made of; they need NumPy and nothing else."""
