"""What the modules that the program starts in its place have in common (tools/base/python)."""

from __future__ import annotations

import contextlib
import os
import signal

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


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
