"""Error against computing time of the integrators, on several motions."""
