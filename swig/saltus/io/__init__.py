"""Results: a run as numpy arrays, in memory, in HDF5 files and as CSV."""

import contextlib
import os

from saltus.io.contact_states import ContactState
from saltus.io.first_order import FirstOrderLayout, FirstOrderTrajectory, read_first_order
from saltus.io.records import (
    ContactLaw,
    ContactRecord,
    Layout,
    PlaceRecord,
    Provenance,
    Scene,
    ShapeRecord,
)
from saltus.io.trajectory import Trajectory, read_hdf5


def read_any(path: str | os.PathLike[str]) -> Trajectory | FirstOrderTrajectory:
    """Read a run from a file, a mechanical or a first-order one. Errors as `read_hdf5`."""
    try:
        return read_hdf5(path)
    except ValueError:
        with contextlib.suppress(ValueError):
            return read_first_order(path)
        raise


__all__ = [
    "ContactLaw",
    "ContactRecord",
    "ContactState",
    "FirstOrderLayout",
    "FirstOrderTrajectory",
    "Layout",
    "PlaceRecord",
    "Provenance",
    "Scene",
    "ShapeRecord",
    "Trajectory",
    "read_any",
    "read_first_order",
    "read_hdf5",
]
