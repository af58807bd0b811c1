"""Saltus simulates mechanical systems whose velocities jump: contact, impact, dry friction.

``saltus.kernel`` has models, integrators and simulations, ``saltus.numerics`` the solvers of contact
problems, ``saltus.io`` the results. `compiled` makes fast model functions.
"""

from saltus._core import __version__
from saltus.functions import compiled

__all__ = ["__version__", "compiled"]
