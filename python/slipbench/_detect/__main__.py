"""`python -m slipbench._detect FILE`: started by the program.

Exit status 2 for bad input, with its message.
"""

from __future__ import annotations

import json
import sys
from typing import Any

from slipbench._detect import write_parquet
from slipbench._program import interruptible, read_request, run_command, write_result
from slipbench.bin import _core


def run(request: dict[str, Any]) -> int:
    """Writes the alarms and prints the result; returns the exit status."""
    with interruptible("stopping; nothing is kept") as interrupt:
        import pyarrow  # noqa: F401  # fails before the work if it is missing

        result, _ = _core.detect(
            request["detector"],
            list(request["parameters"].items()),
            request["recordings"],
            request["sensor"],
            "",
            request["resample"],
        )
        interrupt.check()
        files = write_parquet(request["output"], json.loads(result))
    return write_result(lambda: _core.print_detection(result, files, request["json"]))


def main(request: dict[str, Any]) -> int:
    """Runs the request: the arguments of detect(), `json` and `install`.

    Returns the exit status.
    """
    return run_command(
        lambda: run(request),
        needs="detect -o FILE.parquet",
        install=request["install"],
        target=request["output"],
    )


if __name__ == "__main__":
    sys.exit(main(read_request()))
