"""Importers of measured displacement fields, one vendor format a module."""
