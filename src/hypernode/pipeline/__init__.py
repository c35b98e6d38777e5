"""What the Snakefile asks: which jobs there are, how one runs, how it compiles."""
