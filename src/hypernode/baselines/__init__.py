"""Classical identifications without networks: what each assumes, and the moduli that follow."""
