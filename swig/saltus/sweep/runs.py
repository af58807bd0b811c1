"""Makes the runs of a study that are missing, and keeps each as a file as soon as it is done."""

from __future__ import annotations

import json
import logging
import os
import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count, islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from saltus import __version__
from saltus.io.files import new_file, writable_folder
from saltus.sweep import worker
from saltus.sweep.study import Run, Study, read_study
from saltus.sweep.worker import DIED, DONE, Task

if TYPE_CHECKING:
    from distributed import Client, Future

LEAST_WINDOW = 64  #: runs that dask knows of at once, at least, and
WINDOW = 4  #: for each thread: a study may have very many

LOCAL = "127.0.0.1:0"  # nobody else shall see what dask serves

Progress: TypeAlias = Callable[[int, int, int, int], object]
"""Called with the numbers of runs in all, there before, made now, and failed."""


@dataclass(frozen=True)
class Sweep:
    """What there is of a study, in the order of its runs."""

    study: Study
    folder: Path
    records: tuple[Mapping[str, Any], ...]  #: of each run: status, figures, error, seconds, ...
    made: int  #: by this call
    other_runs: int  #: in the folder, of another state of the study or another version of Saltus

    @property
    def failed(self) -> tuple[Mapping[str, Any], ...]:
        """Those without result."""
        return tuple(record for record in self.records if record["status"] != DONE)

    @property
    def table(self) -> Path:
        """The table in Parquet; beside it are table.csv, times.csv, with wall-clock times, and sweep.png."""
        return self.folder / "table.parquet"


def run_study(
    path: str | os.PathLike[str],
    out: str | os.PathLike[str] | None = None,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    time_out: float | None = None,
    keep: bool = False,
    retry_failed: bool = False,
    progress: Progress | None = None,
) -> Sweep:
    """Make the runs of a study that are missing, and write the table and the picture.

    Results do not depend on the workers: the files of the table are the same to the last bit.

    Parameters
    ----------
    path : file of the study, see `Study`
    out : folder of the results, ``out/sweep/NAME`` if not given
    workers : processes on this machine, as many as it has cores if not given
    scheduler : address of a dask scheduler, whose workers then make the runs
    time_out : of a run [s], with composing and measuring
    keep : write every trajectory to ``trajectories/ID.h5``. Runs that are there without one are made again.
        Workers on other machines need the same file system
    retry_failed : make failed runs again; otherwise they stay failed
    progress : called after every run

    Raises
    ------
    ValueError
        If the study or an option makes no sense, or no scheduler answers.
    ImportError
        If dask.distributed or pyarrow is missing.
    OSError
        If the folder cannot be written.
    KeyboardInterrupt
        After Ctrl-C, when all processes have ended. What was done is kept.
    """
    _require_packages()
    _check(workers, scheduler, time_out)
    study = read_study(path)
    folder = writable_folder(out or Path("out/sweep") / study.path.stem)
    store = _Store(folder, keep)
    runs = {run.identity: run for run in study.runs()}
    missing = [run for run in runs.values() if not store.has(run, retry_failed)]
    failed = sum(store.failed(identity) for identity in runs) if not retry_failed else 0
    before = len(runs) - len(missing)
    if missing:
        with _client(workers, scheduler) as (client, sweep):
            tasks = (_task(study, run, store, time_out) for run in missing)
            for made, (run, answer) in enumerate(_answers(client, sweep, tasks), start=1):
                store.write(run, answer)
                failed += answer["status"] != DONE
                if progress is not None:
                    progress(len(runs), before, made, failed)
    records = tuple(store.read(run.identity) for run in study.runs())
    found = Sweep(study, folder, records, len(missing), store.others(runs))
    from saltus.sweep.picture import write_picture
    from saltus.sweep.table import write_tables

    write_tables(found)
    write_picture(found)
    return found


class _Store:
    """The files of runs in a folder."""

    def __init__(self, folder: Path, keep: bool) -> None:
        self._folder = writable_folder(folder / "runs")
        self._trajectories = writable_folder(folder / "trajectories") if keep else None
        self._status = {}
        for file in self._folder.glob("*.json"):
            try:
                self._status[file.stem] = str(json.loads(file.read_text(encoding="utf-8"))["status"])
            except (ValueError, KeyError, TypeError):
                continue  # is no result, and will be replaced by one

    def has(self, run: Run, retry_failed: bool) -> bool:
        """True if the run is there, as it is wanted."""
        kept = self.trajectory(run)
        if self._status.get(run.identity) == DONE:
            return kept is None or kept.is_file()
        return run.identity in self._status and not retry_failed

    def failed(self, identity: str) -> bool:
        """True if it is there without result."""
        return self._status.get(identity, DONE) != DONE

    def others(self, runs: Mapping[str, Run]) -> int:
        """How many there are besides these."""
        return len(self._status.keys() - runs.keys())

    def trajectory(self, run: Run) -> Path | None:
        """Where its trajectory is, if they are kept."""
        return self._trajectories and (self._trajectories / f"{run.identity}.h5").resolve()

    def write(self, run: Run, answer: Mapping[str, Any]) -> None:
        """Keep what became of a run."""
        with new_file(self._folder / f"{run.identity}.json") as new:
            content = {"id": run.identity, **run._asdict(), "version": __version__, **answer}
            del content["identity"]
            new.part.write_text(json.dumps(content, indent=1, ensure_ascii=False), encoding="utf-8")
        self._status[run.identity] = answer["status"]

    def read(self, identity: str) -> dict[str, Any]:
        """What became of it."""
        content: dict[str, Any] = json.loads((self._folder / f"{identity}.json").read_text(encoding="utf-8"))
        return content


def _task(study: Study, run: Run, store: _Store, time_out: float | None) -> Task:
    kept = store.trajectory(run)
    return Task(
        __version__, study.source, str(study.path), run, time_out, None if kept is None else str(kept)
    )


def _answers(client: Client, sweep: str, tasks: Iterator[Task]) -> Iterator[tuple[Run, dict[str, Any]]]:
    """What becomes of each run, as they are done; dask knows of a few at once.

    If a worker dies, all that it was given may be the reason: these runs are made again alone, in the end.
    """
    from distributed import KilledWorker, as_completed

    of: dict[Future[Any], Task] = {}
    numbers = count()
    suspects: list[Task] = []
    alone: set[str] = set()

    def submit(task: Task) -> Future[Any]:
        number = next(numbers)
        key = f"run-{sweep}-{number}"  # of one group, which dask does not give out in advance
        future = client.submit(worker.make, sweep, task, key=key, priority=-number, pure=False)
        of[future] = task
        return future

    window = max(LEAST_WINDOW, WINDOW * sum(client.nthreads().values()))
    done = as_completed([submit(task) for task in islice(tasks, window)], loop=client.loop)
    try:
        for future in done:
            task = of.pop(future)
            try:
                yield task.run, future.result()
            except KilledWorker as error:
                if task.run.identity in alone:
                    message = str(error).replace(future.key, task.run.identity)
                    yield task.run, worker.failure(DIED, "KilledWorker", message)
                else:
                    suspects.append(task)
            for following in islice(tasks, 1):
                done.add(submit(following))
            if not of and suspects:
                alone.add(suspects[0].run.identity)
                done.add(submit(suspects.pop(0)))
    finally:
        client.cancel(list(of))


@contextmanager
def _client(workers: int | None, scheduler: str | None) -> Iterator[tuple[Client, str]]:
    """A client, and the name under which its workers know this sweep, whose processes end with it."""
    from distributed import Client, LocalCluster

    sweep = uuid.uuid4().hex[:12]
    if scheduler is not None:
        try:
            client = Client(scheduler, set_as_default=False)
        except (OSError, ValueError) as error:
            raise ValueError(f"no dask scheduler answers at '{scheduler}': {error}") from error
        with client:
            try:
                yield client, sweep
            finally:
                client.run(worker.close, sweep, on_error="ignore")
        return
    with (
        _quiet(),
        LocalCluster(
            n_workers=1,
            threads_per_worker=workers or len(os.sched_getaffinity(0)),
            processes=False,  # threads are enough: each waits for a process of its own, which makes the runs
            dashboard_address=LOCAL,
            worker_dashboard_address=LOCAL,
            memory_limit=None,
            silence_logs=False,
        ) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):
        try:
            yield client, sweep
        finally:
            worker.close(sweep)


@contextmanager
def _quiet() -> Iterator[None]:
    """Nothing is said of the workers within this process: they end when the sweep does."""
    logger = logging.getLogger("distributed")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(level)


def _check(workers: int | None, scheduler: str | None, time_out: float | None) -> None:
    if workers is not None and workers < 1:
        raise ValueError(f"workers must be at least one, got {workers}")
    if workers is not None and scheduler is not None:
        raise ValueError(
            "expected either workers on this machine or a scheduler, which has its own, got both"
        )
    if time_out is not None and not 0 < time_out < float("inf"):
        raise ValueError(f"a time-out must be positive and finite, in s, got {time_out:g}")


def _require_packages() -> None:
    try:
        import distributed  # noqa: F401
        import pyarrow  # noqa: F401
    except ImportError as error:
        raise ImportError(
            f"sweeps need dask.distributed and pyarrow: pip install 'saltus[sweep]' ({error})"
        ) from error


def figures_of(records: Sequence[Mapping[str, Any]]) -> list[str]:
    """Names of all figures, those of the study before those of every run."""
    names = [name for record in records for name in record.get("figures", {})]
    own = [name for name in dict.fromkeys(names) if name not in worker.STANDARD_UNITS]
    return [*own, *worker.STANDARD_UNITS]
