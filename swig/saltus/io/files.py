"""New files that take their place when they are complete."""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


class NewFile:
    """A file that is written under another name beside its target, which `publish` then replaces as a whole.

    Until then, and if it comes to nothing, what was at the target is untouched.

    Raises
    ------
    OSError
        If the target is no regular file, or its folder is missing or cannot be written.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.target = Path(os.path.realpath(path))  # a link stays one: its target is replaced
        if self.target.exists() and not self.target.is_file():
            raise unwritable(self.target, OSError(errno.EISDIR, "not a regular file"))
        try:
            descriptor, name = tempfile.mkstemp(
                dir=self.target.parent, prefix=self.target.name, suffix=".part"
            )
            os.close(descriptor)
        except OSError as error:
            raise unwritable(self.target, error) from error
        self.part = Path(name)

    def publish(self) -> None:
        """Put the file in its place."""
        os.chmod(self.part, 0o666 & ~_umask())
        os.replace(self.part, self.target)

    def discard(self) -> None:
        """Remove the file unless it is in its place."""
        self.part.unlink(missing_ok=True)


def writable_folder(path: str | os.PathLike[str]) -> Path:
    """Make a folder, unless it is there, and try it.

    Raises
    ------
    OSError
        If files cannot be written into it.
    """
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / ".writable"
        probe.touch()
        probe.unlink()
    except OSError as error:
        reason = f"cannot write into '{folder}': expected a writable folder, got: {error.strerror}"
        raise OSError(error.errno or 0, reason) from error
    return folder


@contextmanager
def new_file(path: str | os.PathLike[str]) -> Iterator[NewFile]:
    """A file to be written as `part`, which takes its place if nothing is raised. Errors as `NewFile`."""
    new = NewFile(path)
    try:
        yield new
        new.publish()
    except OSError as error:
        raise unwritable(new.target, error) from error
    finally:
        new.discard()


def unwritable(target: Path, error: Exception) -> OSError:
    """An error that names the target and says what was expected."""
    reason = getattr(error, "strerror", None) or str(error)
    return OSError(
        getattr(error, "errno", None) or 0,
        f"cannot write '{target}': expected a writable file in an existing folder, got: {reason}",
    )


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
