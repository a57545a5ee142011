"""Names of the arguments of `train()` in its messages: those of Python, or the options of `slipbench train`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

_UNLIKE = {"by_score": "--score", "every_trial": "--all"}  # options with another name than the argument
_from_command = ContextVar("_from_command", default=False)


@contextmanager
def naming_options() -> Iterator[None]:
    """Messages name the options of the command line instead of Python's arguments."""
    token = _from_command.set(True)
    try:
        yield
    finally:
        _from_command.reset(token)


def named(argument: str, value: Any = None) -> str:
    """The name of an argument for a message.

    Args:
        argument: of `train()`, such as "held_out"
        value: to show with it; None: the name alone

    Returns:
        "held_out=0.7" or "--held-out 0.7"; a value of True is not shown of an option: "resume=True" or "--resume".
    """
    if not _from_command.get():
        return argument if value is None else f"{argument}={value!r}"
    option = _UNLIKE.get(argument, f"--{argument.replace('_', '-')}")
    return option if value is None or value is True else f"{option} {value}"
