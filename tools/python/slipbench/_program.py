"""What the modules that the program starts in its place have in common (tools/base/python)."""

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


WIDTH = 100  # columns, where there is no terminal
LEAST_WIDTH = 40  # columns: a narrower terminal breaks the lines itself


class Interrupted(Exception):
    """A signal has asked to end."""


class Interrupt:
    """Catches the signals of SIGNALS that are not ignored, also those that the program has blocked until now.

    The first signal is noted and reported by check(): an exception in a destructor or an import would be lost there.
    The second ends the process.

    Args:
        notice: what the first signal prints on stderr, such as "stopping after this trial"
    """

    def __init__(self, notice: str) -> None:
        self._asked = False
        self._notice = f"slipbench: {notice}; once more to stop at once\n"
        for number in SIGNALS:
            if signal.getsignal(number) != signal.SIG_IGN:
                signal.signal(number, self._note)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)

    def check(self) -> None:
        """Raises Interrupted once a signal has come."""
        if self._asked:
            raise Interrupted

    def _note(self, number: int, _: object) -> None:
        signal.signal(number, signal.SIG_DFL)
        if self._asked:
            signal.raise_signal(number)  # another signal came first; this one's action is the default again
        self._asked = True
        with contextlib.suppress(OSError):  # nothing can be done where stderr cannot be written
            os.write(2, (("\r\033[K" if os.isatty(2) else "") + self._notice).encode())


def write_whole(path: Path, data: bytes) -> None:
    """Writes PATH.partial, syncs it and renames it, so that PATH is whole at any time.

    Args:
        path: of the file; an earlier one is replaced
        data: all that the file holds

    Raises:
        OSError: the file cannot be written; PATH is unchanged and nothing is left beside it
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
    """ "1 file", "2 files". `what`: the singular of a word whose plural ends with s."""
    return f"{count} {what}{'' if count == 1 else 's'}"


def watched(stream: TextIO) -> bool:
    """Returns True if the stream is a terminal."""
    return stream.isatty() and os.environ.get("TERM") != "dumb"


def styled(stream: TextIO, code: str, text: str) -> str:
    """Text in a colour or weight, where a person watches the stream and NO_COLOR is not set."""
    return f"\033[{code}m{text}\033[0m" if watched(stream) and not os.environ.get("NO_COLOR") else text


def text_width() -> int:
    """Columns of text on stdout."""
    return max(LEAST_WIDTH, min(WIDTH, shutil.get_terminal_size((WIDTH, 1)).columns)) if watched(sys.stdout) else WIDTH


def write_result(write: Callable[[], None]) -> int:
    """Prints the result of a command; returns the exit status. A reader who has gone ends the process by SIGPIPE, as it ends the program."""
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    try:
        if sys.stdout is None:  # it was closed before Python began
            raise OSError(9, "Bad file descriptor")
        write()
        sys.stdout.flush()
    except OSError as error:
        print(f"{styled(sys.stderr, '1;31', 'slipbench:')} cannot write to standard output: {error.strerror}", file=sys.stderr)
        if sys.stdout is not None:
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # what is left cannot be written at exit either
        return 2
    return 0
