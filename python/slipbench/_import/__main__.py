"""`python -m slipbench._import FILE`: started by the program; FILE holds the request.

Exit status 2 for bad input, with its message.
"""

from __future__ import annotations

import sys
from typing import Any

from slipbench._import import read_mapped
from slipbench._program import interruptible, read_request, run_command, write_result
from slipbench.bin import _core


def run(request: dict[str, Any]) -> int:
    """Imports the recordings and prints the result; returns the exit status."""
    options = _core.import_options(
        request["sources"],
        "",
        request["map"],
        request["output"],
        request["seed"],
        request["rate"],
    )
    from slipbench._import.labels import limit_searches

    limit_searches()
    with interruptible("stopping; nothing is kept") as interrupt:
        writer = read_mapped(options, interrupt)
    return write_result(lambda: writer.print(request["json"]))


def main(request: dict[str, Any]) -> int:
    """Runs the request: the arguments of import_recordings(), `json` and `install`.

    Returns the exit status.
    """
    return run_command(
        lambda: run(request),
        needs="import --map",
        install=request["install"],
        target=request["output"],
    )


if __name__ == "__main__":
    sys.exit(main(read_request()))
