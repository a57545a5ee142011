"""`python -m slipbench._export FILE`: started by the program; FILE holds the request. Exit status 2
for bad input, with its message."""

import importlib
import json
import sys
from pathlib import Path

from slipbench import open as open_dataset
from slipbench._export.request import Progress, Request, tell
from slipbench._program import Interrupt, run_command, write_result


def run(request: Request, progress: Progress) -> int:
    """Writes the requested files; returns the exit status."""
    try:
        writer = importlib.import_module(
            f"slipbench._export.{'card' if request.files else request.format}"
        )
        with open_dataset(
            request.dataset, check=False
        ) as data:  # the program has checked the digests
            files = writer.write(data, request, progress)
        progress.end_notes()
    finally:
        progress.clear()
    return write_result(lambda: tell(request, files))


def main(path: str) -> int:
    """Runs the request in the file `path`; returns the exit status."""
    request = Request(**json.loads(Path(path).read_bytes()))
    progress = Progress(request, Interrupt("stopping after this trial"))
    return run_command(
        lambda: run(request, progress),
        needs=f"export: --format {request.format}",
        install=request.install,
        target=request.out,
        interrupted=lambda: "",
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
