"""Common functions of the modules that the program starts in its place (tools/workers/python_package)."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TextIO

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


WIDTH = 100  # columns without a terminal
LEAST_WIDTH = 40  # columns; a narrower terminal wraps the lines itself


class Interrupted(Exception):
    """A signal asked the process to stop."""


class Interrupt:
    """Catches the signals of SIGNALS that are not ignored, including those that the program has
    blocked until now.

    The first signal is recorded, and reported by check(), since an exception in a destructor or an
    import would be lost. The second signal ends the process.

    Args:
        notice: text on stderr for the first signal, such as "stopping after this trial"
    """

    def __init__(self, notice: str) -> None:
        self._asked = False
        self._notice = f"slipbench: {notice}; interrupt again to stop at once\n"
        for number in SIGNALS:
            if signal.getsignal(number) != signal.SIG_IGN:
                signal.signal(number, self._note)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)

    def check(self) -> None:
        """Raises Interrupted after a signal."""
        if self._asked:
            raise Interrupted

    def _note(self, number: int, _: object) -> None:
        signal.signal(number, signal.SIG_DFL)
        if self._asked:
            signal.raise_signal(number)  # the default action is restored: this is the second signal
        self._asked = True
        with contextlib.suppress(OSError):  # the notice is optional if stderr is not writable
            os.write(2, (("\r\033[K" if os.isatty(2) else "") + self._notice).encode())


def write_whole(path: Path, data: bytes) -> None:
    """Writes PATH.partial, syncs it and renames it, so that PATH is complete at any time.

    Args:
        path: path of the file; an existing file is replaced
        data: content of the file

    Raises:
        OSError: the file cannot be written; PATH is unchanged and no other file remains
    """
    partial = path.with_name(path.name + ".partial")
    try:
        with partial.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        partial.replace(path)
    except OSError:
        with contextlib.suppress(OSError):
            partial.unlink(missing_ok=True)
        raise


def counted(count: int, what: str) -> str:
    """ "1 file", "2 files". `what`: the singular of a word whose plural ends in s."""
    return f"{count} {what}{'' if count == 1 else 's'}"


def watched(stream: TextIO) -> bool:
    """True if the stream is a terminal that is not "dumb"."""
    return stream.isatty() and os.environ.get("TERM") != "dumb"


def styled(stream: TextIO, code: str, text: str) -> str:
    """Text in a colour or weight, if the stream is a terminal and NO_COLOR is not set."""
    return f"\033[{code}m{text}\033[0m" if watched(stream) and not os.environ.get("NO_COLOR") else text


def text_width() -> int:
    """Columns of text on stdout."""
    return max(LEAST_WIDTH, min(WIDTH, shutil.get_terminal_size((WIDTH, 1)).columns)) if watched(sys.stdout) else WIDTH


def write_result(write: Callable[[], None]) -> int:
    """Prints the result of a command; returns the exit status. If the reader has closed the pipe,
    SIGPIPE ends the process, as it ends the program."""
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    try:
        if sys.stdout is None:  # closed before Python started
            raise OSError(9, "Bad file descriptor")
        write()
        sys.stdout.flush()
    except OSError as error:
        print(f"{styled(sys.stderr, '1;31', 'slipbench:')} cannot write to standard output: {error.strerror}", file=sys.stderr)
        if sys.stdout is not None:
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # otherwise the exit would fail to write the rest
        return 2
    return 0
