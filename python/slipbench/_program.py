"""Common functions of the modules that the program starts in its place (tools/workers/python_package)."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import signal
import sys
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TextIO

from slipbench.bin import _core

GOOD, BAD_INPUT, INTERRUPTED = 0, 2, 130  # exit statuses, as the program's
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


WIDTH = 100  # columns without a terminal
LEAST_WIDTH = 40  # columns; a narrower terminal wraps the lines itself


def read_request() -> dict[str, Any]:
    """The request of the program: JSON in the file that the command line names."""
    request: dict[str, Any] = json.loads(Path(sys.argv[1]).read_bytes())
    return request


@contextlib.contextmanager
def interruptible(notice: str) -> Iterator[_core.Interrupt]:
    """Catches the signals of SIGNALS that are not ignored.

    They include those that the program has blocked until now.

    The first signal prints `notice`, such as "stopping after this trial", and the next check() of
    the yielded object raises KeyboardInterrupt: an exception at any other place, such as a
    destructor or an import, would be lost. The second signal ends the process.
    """
    with _core.Interrupt(notice) as interrupt:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)
        yield interrupt


def counted(count: int, what: str) -> str:
    """A number of things: "1 file", "2 files".

    `what`: the singular of a word whose plural ends in s.
    """
    return f"{count} {what}{'' if count == 1 else 's'}"


def watched(stream: TextIO) -> bool:
    """True if the stream is a terminal that is not "dumb"."""
    return stream.isatty() and os.environ.get("TERM") != "dumb"


def styled(stream: TextIO, code: str, text: str) -> str:
    """Text in a colour or weight, if the stream is a terminal and NO_COLOR is not set."""
    return (
        f"\033[{code}m{text}\033[0m" if watched(stream) and not os.environ.get("NO_COLOR") else text
    )


def text_width() -> int:
    """Columns of text on stdout."""
    return (
        max(LEAST_WIDTH, min(WIDTH, shutil.get_terminal_size((WIDTH, 1)).columns))
        if watched(sys.stdout)
        else WIDTH
    )


def printable(text: str, lines: bool = False) -> str:
    """Text for a terminal or a page, with characters that it must not show as escapes.

    These are control characters, and characters that change the direction of text or are invisible.
    Line ends stay with `lines`. The text may come from an untrusted file.
    """
    return _core.printable(
        text.encode("utf-8", "backslashreplace").decode(), lines
    )  # names of files may not be UTF-8


def say(text: str) -> None:
    """Writes text on stderr.

    Errors are ignored, so that the work continues if stderr is closed or full.
    """
    with contextlib.suppress(OSError, ValueError):
        if sys.stderr is None:
            return
        try:
            sys.stderr.write(text)
            sys.stderr.flush()
        except OSError:
            os.dup2(
                os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno()
            )  # otherwise the exit would fail to write the rest


def say_error(message: str) -> None:
    """Prints an error as the program does: "slipbench: MESSAGE"."""
    say(f"{styled(sys.stderr, '1;31', 'slipbench:')} {printable(message, lines=True)}\n")


def write_result(write: Callable[[], None]) -> int:
    """Prints the result of a command; returns the exit status.

    If the reader has closed the pipe, SIGPIPE ends the process, as it ends the program.
    """
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    try:
        if sys.stdout is None:  # closed before Python started
            raise OSError(9, "Bad file descriptor")
        write()
        sys.stdout.flush()
    except OSError as error:
        say_error(f"cannot write to standard output: {error.strerror}")
        if sys.stdout is not None:
            os.dup2(
                os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno()
            )  # otherwise the exit would fail to write the rest
        return BAD_INPUT
    return GOOD


def catch_signals() -> None:
    """Lets the signals of SIGNALS that are not ignored raise KeyboardInterrupt.

    They include those that the program has blocked until now. For commands that keep nothing.
    """
    for number in SIGNALS:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, signal.default_int_handler)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)


def run_command(
    work: Callable[[], int],
    *,
    needs: str = "",
    install: str = "",
    target: str = "",
    interrupted: Callable[[], str] = lambda: "interrupted; nothing is kept",
) -> int:
    """Runs a command and ends it as the program ends its own: every error is one message on stderr.

    Args:
        work: the command; returns its exit status
        needs: the feature that needs further packages, such as "import --map"
        install: command that installs these packages; empty: the error states it
        target: path that is named if an error of the system names none
        interrupted: text for the user after a signal; empty: none

    Returns:
        The exit status of `work`; 2 after bad input, an error of the system or an internal error;
        130 after a signal.
    """
    try:
        return work()
    except KeyboardInterrupt:  # also from C++ code
        if text := interrupted():
            say(f"slipbench: {text}\n")
        return INTERRUPTED
    except Exception as error:  # noqa: BLE001  a bug: the user is the only one who can report it
        message = input_error_text(error, needs, install, target) or _internal(error)
    sys.unraisablehook = lambda _: (
        None
    )  # writers that are destroyed unclosed would repeat the error with a traceback
    say_error(message)
    return BAD_INPUT


def input_error_text(error: Exception, needs: str, install: str, target: str) -> str:
    """The message of an error that the user can mend; empty for any other error.

    Arguments as for run_command().
    """
    if isinstance(error, _core.InputError):
        return str(error)
    if isinstance(error, ModuleNotFoundError):
        if (error.name or "").partition(".")[0] in ("slipbench", "slipbench_studies"):
            return ""
        if "install it" in str(error):  # of slipbench.learning
            return f"{needs}: {error}"
        return (
            f"{needs} needs the Python package {error.name}, which {sys.executable} does not have; "
            f"install it: {install or f'pip install {error.name}'}"
        )
    if isinstance(error, OSError):
        named = isinstance(error.filename, (str, bytes))
        place = os.fsdecode(error.filename) if named else f"cannot write {target}"
        return f"{place}: {error.strerror or error}"
    return "out of memory" if isinstance(error, MemoryError) else ""


def _internal(error: Exception) -> str:
    """The text of an internal error for its report.

    "internal error, please report it: KeyError: 'x', at _import/text.py:12": the kind of an error,
    its first line, and the innermost line of the package.
    """
    root = Path(__file__).parent
    frames = [
        frame
        for frame in traceback.extract_tb(error.__traceback__)
        if Path(frame.filename).is_relative_to(root)
    ]
    place = (
        f", at {Path(frames[-1].filename).relative_to(root)}:{frames[-1].lineno}" if frames else ""
    )
    first = next(iter(str(error).splitlines()), "")
    return f"internal error, please report it: {type(error).__name__}{': ' if first else ''}{first}{place}"
