"""Siconos's names over the classes of Saltus, so that scripts written for it run: `kernel` and `numerics`.

`adopt` takes models that were made with Siconos itself. See docs/siconos.md.
"""

from saltus.siconos.live_model import adopt

__all__ = ["adopt"]
