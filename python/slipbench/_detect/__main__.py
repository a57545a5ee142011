"""`python -m slipbench._detect REQUEST`: started by the program. Exit status 2 for bad input, with
its message."""

from __future__ import annotations

import json
import sys

from slipbench import InputError
from slipbench._detect import write_parquet
from slipbench._program import Interrupt, Interrupted
from slipbench.bin import _core


def main(text: str) -> int:
    """Runs the request, in JSON: the arguments of detect(), `json` and `install`; returns the exit
    status."""
    request = json.loads(text)
    try:
        interrupt = Interrupt("stopping; nothing is kept")
        import pyarrow  # noqa: F401  # fails before the work if it is missing

        result, _ = _core.detect(request["detector"], list(request["parameters"].items()), request["recordings"], request["sensor"], "")
        interrupt.check()
        files = write_parquet(request["output"], json.loads(result))
        _core.print_detection(result, files, request["json"])
        return 0
    except Interrupted:
        print("slipbench: interrupted; nothing is kept", file=sys.stderr)
        return 130
    except ModuleNotFoundError as error:
        message = f"detect -o FILE.parquet needs the Python package {error.name}, which {sys.executable} does not have; install it: {request['install']}"
    except InputError as error:
        message = str(error)
    print(f"slipbench: {message}", file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
