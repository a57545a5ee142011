"""`python -m slipbench._export FILE`: started by the program; FILE holds the request. Exit status 2
for bad input, with its message."""

import importlib
import json
import sys
from pathlib import Path

from slipbench import InputError, open as open_dataset
from slipbench._export.request import Progress, Request, tell
from slipbench._program import Interrupt, Interrupted


def repeat_nothing(_told: object) -> None:
    """Replaces sys.unraisablehook: writers destroyed unclosed would repeat the error with a
    traceback."""


def main(path: str) -> int:
    """Writes the requested files; returns the exit status."""
    request = Request(**json.loads(Path(path).read_bytes()))
    progress = Progress(request, Interrupt("stopping after this trial"))
    try:
        writer = importlib.import_module(f"slipbench._export.{'card' if request.files else request.format}")
        with open_dataset(request.dataset, check=False) as data:  # the program has checked the digests
            files = writer.write(data, request, progress)
        progress.end_notes()
        tell(request, files)
        return 0
    except ModuleNotFoundError as error:
        message = f"export: --format {request.format} needs the Python package {error.name}, which {sys.executable} does not have; install it: {request.install}"
    except InputError as error:
        message = str(error)
    except OSError as error:
        message = f"{error.filename or request.out}: cannot be written: {error.strerror or error}"
        sys.unraisablehook = repeat_nothing
    except Interrupted:
        progress.clear()
        return 130
    progress.clear()
    print(f"slipbench: {message}", file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
