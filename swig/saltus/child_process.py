"""Processes that do what may hang, run out of memory or crash.

Work in C++ holds the interpreter as long as it goes on, so no thread could stop it. The kernel's timer ends
the process, which is then started again.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import IO, Any

TIME_OUT = -signal.SIGALRM  #: exit status of a process that `ended_after` has ended

_ENDED = (EOFError, BrokenPipeError, pickle.UnpicklingError)  # what is seen of a process that is no more


class EndedError(Exception):
    """The process is no more; `status` is its exit status, negative if a signal ended it."""

    def __init__(self, status: int) -> None:
        super().__init__(f"the process ended with {status}")
        self.status = status


class ChildProcess:
    """The process, seen from outside.

    Parameters
    ----------
    module : its function ``serve()`` is what the process runs
    environment : variables beyond those of this process
    """

    def __init__(self, module: str, environment: Mapping[str, str] | None = None) -> None:
        code = f"import sys; sys.path[:] = {sys.path}; from {module} import serve; serve()"
        self._process = subprocess.Popen(
            [sys.executable, "-c", code],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C is for the command, which ends this process
            env={**os.environ, **(environment or {})},
        )

    def ask(self, request: Any) -> Any:
        """The reply to a request. Raises EndedError if the process ends without one."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            _send(self._process.stdin, request)
            return pickle.load(self._process.stdout)
        except _ENDED:
            raise EndedError(self._closed()) from None

    def kill(self) -> None:
        """End it, whatever it does; who waits for a reply gets EndedError."""
        self._process.kill()

    def end(self) -> None:
        """End it, and wait until it is no more."""
        self.kill()
        self._closed()

    def _closed(self) -> int:
        """Exit status of a process that has ended, or that has closed its end."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(1.0)
        self._process.kill()
        self._process.communicate()
        return self._process.returncode


def serve_requests(answer: Callable[[Any], Any]) -> None:
    """The process from inside: answer what comes, until there is no more. What is printed goes to stderr."""
    requests, replies = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what is printed is no reply
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    with suppress(EOFError, BrokenPipeError):
        while True:
            _send(replies, answer(pickle.load(requests)))


@contextmanager
def ended_after(seconds: float | None) -> Iterator[None]:
    """End this process by SIGALRM if what is inside takes longer; None lets it take its time."""
    signal.setitimer(signal.ITIMER_REAL, seconds or 0.0)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)


def _send(stream: IO[bytes], content: Any) -> None:
    pickle.dump(content, stream, protocol=pickle.HIGHEST_PROTOCOL)
    stream.flush()
