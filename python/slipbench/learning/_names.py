"""Names of the arguments of `train()` in messages.

Python arguments, or options of `slipbench train`.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

_UNLIKE = {
    "by_score": "--score",
    "every_trial": "--all",
}  # options whose name differs from the argument
_from_command = ContextVar("_from_command", default=False)


@contextmanager
def naming_options() -> Iterator[None]:
    """Messages in this context name options of the command line instead of Python arguments."""
    token = _from_command.set(True)
    try:
        yield
    finally:
        _from_command.reset(token)


def named(argument: str, value: Any = None) -> str:
    """Name of an argument in a message.

    Args:
        argument: of `train()`, such as "held_out"
        value: value to show; None: only the name

    Returns:
        "held_out=0.7" or "--held-out 0.7"; True is omitted for an option: "resume=True" or
        "--resume".
    """
    if not _from_command.get():
        return argument if value is None else f"{argument}={value!r}"
    option = _UNLIKE.get(argument, f"--{argument.replace('_', '-')}")
    return option if value is None or value is True else f"{option} {value}"
