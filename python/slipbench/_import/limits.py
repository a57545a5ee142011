"""Limits of files from others.

Which files they may name, and what they may occupy once they are unpacked.
"""

from __future__ import annotations

import contextlib
import errno
import os
import resource
import threading
from collections.abc import Iterable, Iterator
from pathlib import Path

from slipbench import InputError

MOST_MEMORY = (
    32_000_000_000  # bytes for one source: the largest text table needs some ten times its size
)
SHARE_OF_MEMORY = 0.5  # of the machine's memory, for one source
MEMORY_OF_BAG = 4_000_000_000  # bytes beyond those in use, while a bag is read
UNPACKED, UNPACKED_TIMES = (
    1_000_000_000,
    100,
)  # bytes of a file of a bag, or its size as a multiple of the packed size


def check_inside(path: Path, folders: Iterable[Path]) -> None:
    """Raises InputError for a file outside of all `folders` and of the current folder.

    It is named in a file from others, and may be outside by a link.
    """
    if not any(
        path.resolve().is_relative_to(folder.resolve()) for folder in (*folders, Path.cwd())
    ):
        raise InputError(
            f"{path}: is outside of the folders of the map, of the recordings and of the command; to read it, name its folder as a SOURCE, or start "
            "the command in a folder that contains it"
        )


def machine_bytes() -> int:
    """Bytes of memory of the machine."""
    return resource.getpagesize() * os.sysconf("SC_PHYS_PAGES")


def source_limit() -> int:
    """Bytes that one source may take in memory.

    MOST_MEMORY, or half of the machine's memory if that is less.
    """
    return min(MOST_MEMORY, int(SHARE_OF_MEMORY * machine_bytes()))


def data_bytes() -> int:
    """Bytes of private memory in use."""
    pages = int(Path("/proc/self/statm").read_text().split()[5])
    return pages * resource.getpagesize()


_lowering = threading.RLock()  # held by the thread that has lowered limits of the process


@contextlib.contextmanager
def _lowered(kind: int, limit: int) -> Iterator[None]:
    """Lowers a limit of the process within the block. The thread must hold `_lowering`."""
    before, most = resource.getrlimit(kind)
    known = [one for one in (before, most) if one != resource.RLIM_INFINITY]
    resource.setrlimit(kind, (min([limit, *known]), most))
    try:
        yield
    finally:
        resource.setrlimit(kind, (before, most))


@contextlib.contextmanager
def memory_limit(path: str, most: int) -> Iterator[None]:
    """Limits the memory of the process, with all its threads, to `most` bytes beyond those in use.

    Raises InputError naming `path` if the block needs more.
    """
    try:
        with _lowering, _lowered(resource.RLIMIT_DATA, data_bytes() + most):
            yield
    except MemoryError:
        raise InputError(
            f"{path}: needs more than {most / 1e9:.3g} GB of memory when it is unpacked; split the file, or write it with smaller chunks"
        ) from None


@contextlib.contextmanager
def unpacked_limit(path: str) -> Iterator[None]:
    """Limits the size of files that the process writes within the block, which unpacks the bag `path`.

    Raises InputError if the limit is exceeded.
    """
    files = (
        [one for one in Path(path).rglob("*") if one.is_file()]
        if Path(path).is_dir()
        else [Path(path)]
    )
    most = max(UNPACKED, UNPACKED_TIMES * max((one.stat().st_size for one in files), default=0))
    try:
        # Python ignores the signal SIGXFSZ, so that writing fails.
        with _lowering, _lowered(resource.RLIMIT_FSIZE, most):
            yield
    except OSError as error:
        if error.errno != errno.EFBIG:
            raise
        raise InputError(
            f"{path}: a file of the bag unpacks to more than {most / 1e9:.3g} GB; unpack the bag yourself if you trust it"
        ) from None
