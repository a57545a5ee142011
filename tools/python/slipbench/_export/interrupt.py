"""A signal that asks to end is noted, and heeded between two trials: an exception amid a destructor or an import would be lost there."""

from __future__ import annotations

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

    def _note(self, *_: object) -> None:
        self._asked = True
        for number in SIGNALS:
            if signal.getsignal(number) != signal.SIG_IGN:
                signal.signal(number, signal.SIG_DFL)
        os.write(2, (("\r\033[K" if os.isatty(2) else "") + NOTICE).encode())
