"""Fuzz target over the readers of files: valid files, mutated, are read.

python tests/fuzz/readers.py [--seconds N] [--seed S] [--folder FOLDER]
python tests/fuzz/readers.py FILE...    reads these again

What is read must be a valid problem, or a ValueError or OSError with the file's name; soon, and with
little memory. Files are read in a child process, so that a crash is seen, and each is on disk before it is
read. Bytes that crash the HDF5 library itself are kept and counted, not called a failure.
"""

from __future__ import annotations

import argparse
import faulthandler
import io
import os
import random
import re
import resource
import shutil
import sys
import tempfile
import time
import traceback
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
from saltus import numerics
from scipy import sparse

LIMIT = 10  #: s, of one file
MEMORY = 2 << 30  #: beyond what is mapped when it starts
SMALL = 12  #: rows of what is solved as well
HUGE = (
    "-1",
    "0",
    "1",
    "2",
    "3",
    "7",
    "999999999",
    "99999999999999999999",
    "1e308",
    "1e999",
    "nan",
    "-inf",
    "1e-320",
)
BYTES = (b"\xff\xfe", b"\x00", b"\xe2\x80\x83", "٣".encode(), b"-", b"e", b".", b" ", b"\n", b"9" * 5000)


# ---- Valid files


def as_text(matrix: np.ndarray, storage: str) -> str:
    """A matrix as Siconos writes it."""
    n = len(matrix)
    if storage == "dense":
        return f"0\n{n}\n{n}\n{n} {n}\n" + " ".join(f"{x:.17g}" for x in matrix.T.flat) + "\n"
    if storage == "blocks":  # of one row or two
        ends = [0, *range(1 + n % 2, n + 1, 2)] if n > 1 else [0, 1]
        pairs = [(r, c) for r in range(len(ends) - 1) for c in range(len(ends) - 1)]
        blocks = [matrix[ends[r] : ends[r + 1], ends[c] : ends[c + 1]] for r, c in pairs]
        count = len(ends) - 1
        lines = [f"1\n{n}\n{n}\n{len(blocks)}\n{count} {count}", *[" ".join(map(str, ends[1:]))] * 2]
        lines += [f"{count + 1} {len(blocks)}", " ".join(str(r * count) for r in range(count + 1))]
        lines += [" ".join(str(c) for _, c in pairs)]
        lines += [f"{k}\n" + " ".join(f"{x:.17g}" for x in block.T.flat) for k, block in enumerate(blocks)]
        return "\n".join(lines) + "\n"
    text = f"2\n{n}\n{n}\n0\nCSparse Version 3.1.9, Copyright (c) Timothy A. Davis\n"
    if storage == "triplets":
        text += f"triplet: {n}-by-{n}, nzmax: {n * n} nnz: {n * n}\n"
        return text + "".join(f"    {i} {j} : {matrix[i, j]:.17g}\n" for i in range(n) for j in range(n))
    text += f"{n}-by-{n}, nzmax: {n * n} nnz: {n * n}, 1-norm: 7\n"
    for j in range(n):
        text += f"    col {j} : locations {j * n} to {j * n + n - 1}\n"
        text += "".join(f"      {i} : {matrix[i, j]:.17g}\n" for i in range(n))
    return text


def texts() -> list[bytes]:
    def row(values: np.ndarray) -> str:
        return " ".join(f"{x:.17g}" for x in values) + "\n"

    result = []
    for storage in ("dense", "blocks", "columns", "triplets"):
        lcp = numerics.random_lcp("p", 3, 1)
        result.append(f"3\n{as_text(lcp.dense(), storage)}{row(lcp.q)}")
        result.append(f"1 0 1 2\n0 1 3\n0 1\n{as_text(lcp.dense(), storage)}{row(lcp.q)}")
        for dim in (2, 3):
            problem = numerics.random_friction("regular", 2, dim, 1)
            matrix = as_text(problem.dense(), storage)
            result.append(f"{dim}\n2\n{matrix}{row(problem.q)}{row(problem.mu)}")
    result.append("0 1 1 2  1  1 1.5 0 1  2 0  0 0  -1  1 -3\n")
    return [text.encode() for text in result]


def fclib_files() -> list[bytes]:
    """Local problems with the matrix by rows, by columns and as triplets, with and without equalities."""
    made = numerics.random_friction("regular", 3, 2, 1)
    problems = [made, numerics.FrictionProblem(made.W, made.q, made.mu[:2], 2, n_equalities=2)]
    result = []
    for problem in problems:
        for storage in (-2, -1, 0):
            content = io.BytesIO()
            with tempfile.TemporaryDirectory() as folder:
                problem.write(Path(folder) / "a.hdf5")
                content.write((Path(folder) / "a.hdf5").read_bytes())
            with h5py.File(content, "r+") as file:
                group = file["fclib_local/W"]
                shape = int(group["m"][0]), int(group["n"][0])
                rows = sparse.csr_array((group["x"][()], group["i"][()], group["p"][()]), shape=shape)
                if storage == -1:
                    columns = sparse.csc_array(rows)
                    store(group, nz=[-1], p=columns.indptr, i=columns.indices, x=columns.data)
                elif storage == 0:
                    entries = rows.tocoo()
                    store(group, nz=[entries.nnz], i=entries.coords[0], p=entries.coords[1], x=entries.data)
            result.append(content.getvalue())
    return result


def store(group: h5py.Group, **values: object) -> None:
    for name, value in values.items():
        del group[name]
        group[name] = value


# ---- Mutations


def mutate_bytes(chance: random.Random, content: bytes, others: list[bytes]) -> bytes:
    data = bytearray(content)
    for _ in range(chance.choice((1, 1, 1, 2, 4))):
        at = chance.randrange(len(data) + 1)
        end = min(len(data), at + chance.choice((1, 4, 16, 200)))
        match chance.randrange(7):
            case 0 if at < len(data):
                data[at] ^= 1 << chance.randrange(8)
            case 1:
                del data[at:]
            case 2:
                del data[at:end]
            case 3:
                data[at:at] = data[at:end]
            case 4:
                other = chance.choice(others)
                data[at:] = other[chance.randrange(len(other) + 1) :]
            case 5:
                data[at:end] = bytes(chance.randrange(256) for _ in range(end - at))
            case _:
                data[at:at] = chance.choice(BYTES)
    return bytes(data)


def mutate_words(chance: random.Random, content: bytes, others: list[bytes]) -> bytes:
    """Other numbers in the places of some."""
    for _ in range(chance.choice((1, 1, 2))):
        words = list(re.finditer(rb"\S+", content))
        if not words:
            break
        word = chance.choice(words[: chance.choice((8, 16, len(words)))])
        content = content[: word.start()] + chance.choice(HUGE).encode() + content[word.end() :]
    return content


def odd_value(chance: random.Random, old: np.ndarray) -> object:
    """Something else in the place of a dataset."""
    flat = np.array(old).reshape(-1)
    if chance.random() < 0.6 and flat.size and flat.dtype.kind in "iuf":  # of the same kind
        with np.errstate(all="ignore"):
            flat[chance.randrange(flat.size)] = chance.choice(
                (-1, 0, 1, 2, 1 << 20, (1 << 31) - 1, -(1 << 31))
                if flat.dtype.kind in "iu"
                else (np.nan, np.inf, -1.0, 1e308, 5e-324)
            )
        return flat.reshape(np.shape(old))
    return chance.choice(
        (
            lambda: flat[:-1],
            lambda: np.append(flat, flat),
            lambda: flat[:0],
            lambda: flat.reshape(-1, 1),
            lambda: h5py.Empty("f8"),
            lambda: "a text",
            lambda: np.array([b"a", b"text"]),
            lambda: 1 << 40,
            lambda: (1 << 64) - 1,
            lambda: -1,
            lambda: 0.5,
            lambda: np.array([1 + 1j]),
            lambda: np.ones(1, dtype=[("a", "i4"), ("b", "f8")]),
            lambda: np.ones(len(flat), dtype=bool),
            lambda: flat.astype(chance.choice(("f2", "f4", "g", ">f8", "i1", "u8", "S8", ">i4"))),
        )
    )()


def mutate_datasets(chance: random.Random, content: bytes, others: list[bytes]) -> bytes:
    stream = io.BytesIO(content)
    with h5py.File(stream, "r+") as file:
        names: list[str] = []
        file.visit(names.append)
        for _ in range(chance.choice((1, 1, 2))):
            name = chance.choice(names)
            place, old = file.get(name), np.zeros(1)
            if place is None:  # another mutation took it
                continue
            if isinstance(place, h5py.Dataset) and place.dtype.kind in "iuf" and (place.size or 0) < 1000:
                old = place[()]
            del file[name]
            match chance.randrange(10):
                case 0:
                    pass
                case 1:
                    file.create_group(name)
                case 2:
                    file[name] = chance.choice(
                        (h5py.SoftLink("/nowhere"), h5py.ExternalLink("none.h5", "/a"))
                    )
                case 3 | 4:  # without content
                    shape = chance.choice(((1 << 40,), (1 << 20, 1 << 20), (1 << 28,), (1 << 62,)))
                    kind = chance.choice(("f8", "i4", "S100"))
                    file.create_dataset(name, shape, kind, chunks=(1 << 10,) + (1,) * (len(shape) - 1))
                case _:
                    file[name] = odd_value(chance, old)
    return stream.getvalue()


# ---- What is promised of a reader


def read(path: Path) -> str:
    """Read a file as what it says it is. Raises AssertionError or whatever the readers let escape."""
    try:
        problem = numerics.read_problem(path)
    except (ValueError, OSError) as error:
        if str(path) in str(error):
            return "refused"
        raise AssertionError("the message does not name the file") from error
    check(problem)
    return "read"


def check(problem: numerics.Problem) -> None:
    n = problem.q.size
    matrix = problem.W if isinstance(problem, numerics.FrictionProblem) else problem.M  # type: ignore[attr-defined]
    assert matrix.shape == (n, n)
    assert np.isfinite(problem.q).all()
    assert np.isfinite(matrix.data if sparse.issparse(matrix) else matrix).all()
    if n > SMALL:
        return
    assert np.isfinite(problem.dense()).all()
    answer = problem.solve()
    assert answer.solution.shape == (n,)
    assert answer.status != "solved" or answer.residual <= 1e-12


# ---- Child and parent


class Job:
    """The inputs of a seed, one after the other, each in a file before it is read."""

    def __init__(self, seed: int, folder: Path) -> None:
        self.chance = random.Random(seed)
        self.folder = folder
        self.kinds: list[tuple[str, list[bytes], list[Callable[..., bytes]]]] = [
            ("problem.dat", texts(), [mutate_bytes, mutate_words]),
            ("problem.hdf5", fclib_files(), [mutate_bytes, mutate_datasets, mutate_datasets]),
        ]

    def next(self) -> Path:
        name, contents, mutations = self.chance.choice(self.kinds)
        mutation = self.chance.choice(mutations)
        path = self.folder / f"{Path(name).stem}-{mutation.__name__}{Path(name).suffix}"
        path.write_bytes(mutation(self.chance, self.chance.choice(contents), contents))
        (self.folder / "running").write_text(path.name)
        return path


def child(job: Job, until: float) -> None:
    mapped = int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    resource.setrlimit(resource.RLIMIT_AS, (mapped + MEMORY, mapped + MEMORY))
    faulthandler.enable()
    count, outcomes = 0, {"read": 0, "refused": 0}
    while time.monotonic() < until:
        path = job.next()
        faulthandler.dump_traceback_later(LIMIT, exit=True)
        outcomes[read(path)] += 1
        faulthandler.cancel_dump_traceback_later()
        count += 1
    print(f"{count} files, {outcomes['read']} read, {outcomes['refused']} refused", flush=True)


def fork(job: Job, until: float) -> int:
    """Run the child. Returns its status, negative where a signal ended it."""
    pid = os.fork()
    if pid == 0:
        status = 1
        try:
            child(job, until)
            status = 0
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])


def main() -> int:
    parser = argparse.ArgumentParser(description="Fuzz the readers of files.")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--folder", type=Path, default=Path("fuzz-failures"), help="where inputs are kept")
    parser.add_argument("files", nargs="*", type=Path, help="read these instead")
    arguments = parser.parse_args()
    for path in arguments.files:
        print(path, read(path))
    if arguments.files:
        return 0
    until = time.monotonic() + arguments.seconds
    with tempfile.TemporaryDirectory() as folder:
        for attempt in range(1000):  # a new child, and other inputs, after a crash of the HDF5 library
            status = fork(Job(arguments.seed + 1000 * attempt, Path(folder)), until)
            if status == 0:
                return 0
            failed = Path(folder) / (Path(folder) / "running").read_text()
            arguments.folder.mkdir(parents=True, exist_ok=True)
            kept = arguments.folder / f"{failed.stem}-{arguments.seed}-{attempt}{failed.suffix}"
            shutil.copy(failed, kept)
            of_library = status < 0 and failed.stem.endswith("mutate_bytes") and failed.suffix != ".dat"
            print(f"{'the HDF5 library crashes at' if of_library else 'FAILED:'} {kept}", flush=True)
            if not of_library:
                return 1
    return 1


if __name__ == "__main__":
    sys.exit(main())
