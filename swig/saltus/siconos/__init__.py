"""Siconos's names over the classes of Saltus, so that scripts written for it run: `kernel` and `numerics`.

See docs/siconos.md.
"""
