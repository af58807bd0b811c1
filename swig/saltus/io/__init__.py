"""Results: a run as numpy arrays, in memory, in HDF5 files and as CSV."""

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
    "read_first_order",
    "read_hdf5",
]
