"""What a run needs to go on with the same bits, as bytes that tell whether they are complete."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from saltus.io.records import Layout, Provenance

DIGEST = hashlib.sha256().digest_size


def pack(values: Mapping[str, Any], rows: int) -> bytes:
    """A checkpoint of the simulation, and how many rows were recorded until then."""
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, rows=rows, **values)
    return hashlib.sha256(buffer.getvalue()).digest() + buffer.getvalue()


def unpack(data: bytes) -> dict[str, Any] | None:
    """The inverse; nothing if the bytes are not complete. Nothing in them is executed."""
    digest, content = data[:DIGEST], data[DIGEST:]
    if hashlib.sha256(content).digest() != digest:
        return None
    with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
        return {name: array if array.ndim else array.item() for name, array in arrays.items()}


def latest(slots: Sequence[bytes], rows: int) -> dict[str, Any] | None:
    """The last complete one, of a run that has so many complete rows."""
    found = [values for values in map(unpack, slots) if values is not None and values["rows"] <= rows]
    return max(found, key=lambda values: int(values["step"]), default=None)


def require_same(path: object, run: tuple[Layout, Provenance], here: tuple[Layout, Provenance]) -> None:
    """Raise ValueError unless a run can go on with this model and simulation."""
    (layout, provenance), (own_layout, own) = run, here
    pairs = [
        ("integrator", provenance.integrator, own.integrator),
        ("options", dict(provenance.options), dict(own.options)),
        ("time_step", provenance.time_step, own.time_step),
        ("solver", provenance.solver, own.solver),
        ("tolerance", provenance.tolerance, own.tolerance),
        ("record_every", provenance.record_every, own.record_every),
        ("parameters", dict(provenance.parameters), dict(own.parameters)),
        ("coordinates", layout.coordinates, own_layout.coordinates),
        ("contacts", dict(layout.contacts), dict(own_layout.contacts)),
        ("version of Saltus", provenance.version, own.version),
    ]
    for what, theirs, ours in pairs:
        if theirs != ours:
            raise ValueError(
                f"the run in '{path}' goes on only with its own {what}, {_short(theirs)}, got {_short(ours)}"
            )


def _short(value: object) -> str:
    text = str(value)
    return text if len(text) <= 200 else text[:197] + "..."
