"""The table of a sweep: Parquet and CSV."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from saltus.io.files import new_file
from saltus.sweep.runs import figures_of
from saltus.sweep.worker import STANDARD_UNITS

if TYPE_CHECKING:
    from saltus.sweep.runs import Sweep

UNITS = {**STANDARD_UNITS, "time_step": "s", "until": "s"}


def write_tables(sweep: Sweep) -> None:
    """Write table.parquet and table.csv, the same to the last bit for the same study, and times.csv."""
    columns = columns_of(sweep)
    units = {**UNITS, **sweep.study.units}
    _write_parquet(columns, units, sweep.table)
    _write_csv(columns, units, sweep.folder / "table.csv")
    times = {name: [record.get(name) for record in sweep.records] for name in ("id", "seconds")}
    _write_csv(times, {"seconds": "s"}, sweep.folder / "times.csv")


def columns_of(sweep: Sweep) -> dict[str, list[Any]]:
    """All columns by name, a value for each run, None where there is none."""
    records = sweep.records
    parameters = dict.fromkeys(name for record in records for name in record["parameters"])
    figures = figures_of(records)
    columns = {"id": [record["id"] for record in records]}
    columns |= {name: _alike([record["parameters"].get(name) for record in records]) for name in parameters}
    columns |= {
        name: [record[name] for record in records] for name in ("integrator", "time_step", "until", "status")
    }
    columns |= {name: _alike([record.get("figures", {}).get(name) for record in records]) for name in figures}
    columns |= {
        name: [record.get(name, "") for record in records] for name in ("error", "message", "traceback")
    }
    columns["warnings"] = ["; ".join(record.get("warnings", [])) for record in records]
    return columns


def _alike(values: Sequence[Any]) -> list[Any]:
    """Values of one type: all lists if one is a list, words if one is a word, floats if one is a float."""
    kinds = {type(value) for value in values if value is not None}
    if len(kinds) < 2:
        return list(values)
    if list in kinds:
        return [value if value is None or isinstance(value, list) else [value] for value in values]
    kind = str if str in kinds else float
    return [None if value is None else kind(value) for value in values]


def _write_parquet(columns: Mapping[str, Sequence[Any]], units: Mapping[str, str], path: Path) -> None:
    import pyarrow
    from pyarrow import parquet

    fields, arrays = [], []
    for name, values in columns.items():
        array = pyarrow.array(values)
        if array.type == pyarrow.null():  # a figure that no run has
            array = array.cast(pyarrow.float64())
        metadata = {"unit": units[name]} if name in units else None
        fields.append(pyarrow.field(name, array.type, metadata=metadata))
        arrays.append(array)
    with new_file(path) as new:
        parquet.write_table(pyarrow.Table.from_arrays(arrays, schema=pyarrow.schema(fields)), new.part)


def _write_csv(columns: Mapping[str, Sequence[Any]], units: Mapping[str, str], path: Path) -> None:
    """Lists are written as in JSON."""
    with new_file(path) as new, new.part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(f"{name} [{units[name]}]" if name in units else name for name in columns)
        for row in zip(*columns.values(), strict=True):
            writer.writerow(json.dumps(value) if isinstance(value, list) else value for value in row)
