"""Columns and pyramids: many contacts that depend on each other."""
