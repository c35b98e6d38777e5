"""Importers: what laboratories bring, turned into a measurement."""
