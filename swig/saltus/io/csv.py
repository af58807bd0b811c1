"""Runs as text."""

from __future__ import annotations

import os
from pathlib import Path

from saltus._core import csv_header, csv_rows
from saltus.io.files import new_file
from saltus.io.records import Layout, Rows

BLOCK = 4096  #: rows that are text at a time


def write_csv(path: str | os.PathLike[str], source: Rows, layout: Layout) -> Path:
    """See `Trajectory.to_csv`."""
    contacts = [(name, slot.rows, slot.gaps) for name, slot in layout.contacts.items()]
    columns, rows = dict(source.columns()), source.rows
    with new_file(path) as new, open(new.part, "w", encoding="utf-8", newline="") as file:
        file.write(csv_header(columns["q"].shape[1], columns["v"].shape[1], contacts))
        for start in range(0, rows, BLOCK):
            file.write(csv_rows({name: values[start : start + BLOCK] for name, values in columns.items()}))
    return new.target
