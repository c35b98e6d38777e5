"""Which further test of a sheet would tell most about its stress."""
