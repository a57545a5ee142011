"""A signal that asks to end is noted, and heeded between two trials: an exception amid a destructor or an import would be lost there."""

from __future__ import annotations

import contextlib
import os
import signal

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
NOTICE = "slipbench: stopping after this trial; once more to stop at once\n"


class Interrupted(Exception):
    """A signal has asked to end."""


class Interrupt:
    """Catches the signals of SIGNALS that are not ignored, also those that the program has held back until now."""

    def __init__(self) -> None:
        self._asked = False
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
            os.write(2, (("\r\033[K" if os.isatty(2) else "") + NOTICE).encode())
