"""Output files: created exclusively, synced, and renamed together once all are complete."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import stat
from pathlib import Path
from types import TracebackType
from typing import BinaryIO

from slipbench.bin import _core

RUNNING = "another run is writing it"


def partial_path(path: Path) -> Path:
    """Name of a file while it is written: PATH.partial."""
    return path.with_name(path.name + ".partial")


def sync_folder(folder: Path) -> None:
    """Syncs a folder, so that the names in it survive a power failure."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in (
            errno.EINVAL,
            errno.ENOTSUP,
        ):  # file systems that cannot sync folders
            raise
    finally:
        os.close(descriptor)


def _open_locked(path: Path, flags: int) -> BinaryIO:
    """Opens a regular file without following links and locks it against other runs."""
    try:
        # O_NONBLOCK: a named pipe without a reader is refused, too.
        descriptor = os.open(
            path, flags | os.O_RDWR | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC, 0o666
        )
    except OSError as error:
        if error.errno == errno.ELOOP:
            raise _core.InputError(
                f"cannot write {path}: it is a symbolic link, which would not be followed; remove it"
            ) from None
        raise
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        opened = os.fstat(descriptor)
        if not stat.S_ISREG(opened.st_mode):
            raise _core.InputError(f"cannot write {path}: it is not a regular file")
        # The run that held the lock before may have renamed or removed the file.
        if not os.path.samestat(opened, os.lstat(path)):
            raise FileNotFoundError
        return os.fdopen(descriptor, "w+b")
    except (BlockingIOError, FileNotFoundError):
        os.close(descriptor)
        raise _core.InputError(f"cannot write {path}: {RUNNING}") from None
    except BaseException:
        os.close(descriptor)
        raise


def create_locked(path: Path) -> BinaryIO:
    """Creates a file exclusively. It is locked against other runs until it is closed.

    An unlocked regular file of this name was left by a killed run; a new file replaces it, so that
    neither a symbolic nor a hard link at this name is ever written through.

    Args:
        path: path of the file

    Returns:
        The empty file, opened for writing and reading.

    Raises:
        InputError: another run is writing the file, or it is not a regular file
        OSError: it cannot be created
    """
    while True:
        try:
            return _open_locked(path, os.O_CREAT | os.O_EXCL)
        except FileExistsError:
            with contextlib.suppress(FileNotFoundError), _open_locked(path, 0):
                path.unlink()


class NewFiles:
    """Files that get their names together once all are complete and on the disk.

    If the block is left before publish(), no file remains and existing files are unchanged.

    Example: `with NewFiles() as files: files.create(path).write(data); files.publish()`.
    """

    def __init__(self) -> None:
        self._files: dict[Path, BinaryIO] = {}

    def __enter__(self) -> NewFiles:
        return self

    def create(self, path: Path) -> BinaryIO:
        """Creates PATH.partial for the content of PATH, as create_locked().

        The caller may close the file once it is complete.
        """
        file = create_locked(partial_path(path))
        self._files[path] = file
        return file

    def publish(self) -> None:
        """Syncs the files and renames them to their names; existing files are replaced.

        Raises OSError if this fails.
        """
        for path, file in self._files.items():
            if not file.closed:
                file.flush()
                os.fsync(file.fileno())
            else:
                with partial_path(path).open("rb") as written:
                    os.fsync(written.fileno())
        folders = {path.parent for path in self._files}
        for path in list(self._files):
            partial_path(path).replace(path)
            self._files.pop(path).close()
        for folder in folders:
            sync_folder(folder)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for path, file in self._files.items():
            with contextlib.suppress(OSError):
                partial_path(path).unlink()
            with contextlib.suppress(OSError):  # a full disk: the buffer cannot be written
                file.close()


def write_whole(path: Path, data: bytes) -> None:
    """Writes a file so that it is complete at any time, as NewFiles.

    Args:
        path: path of the file; an existing file is replaced
        data: content of the file

    Raises:
        OSError, InputError: the file cannot be written; it is unchanged and no other file remains
    """
    with NewFiles() as files:
        files.create(path).write(data)
        files.publish()
