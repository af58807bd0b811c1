"""A sphere that slides and then rolls, and an oblique impact."""
