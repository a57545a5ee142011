"""`python -m slipbench._export FILE`: started by the program; FILE holds the request.

Exit status 2 for bad input, with its message.
"""

import sys
from typing import Any

from slipbench._export import write
from slipbench._export.request import Progress, Request
from slipbench._program import (
    interruptible,
    printable,
    read_request,
    run_command,
    say,
    write_result,
)
from slipbench.bin import _core


def run(request: Request, json: bool, quiet: bool, verbose: bool) -> int:
    """Writes the requested files and prints the result; returns the exit status."""
    with interruptible("stopping after this trial") as interrupt:

        def note(text: str) -> None:
            say(f"slipbench: note: {printable(text)}\n")

        files = write(request, Progress(request, interrupt, note, json or quiet))
    return write_result(lambda: _core.print_export(files, request.out, json, quiet, verbose))


def main(words: dict[str, Any]) -> int:
    """Runs the program's request; returns the exit status.

    Args:
        words: export, the fields of Request; json, quiet and verbose, the program's options;
            install, the command that installs the format's requirements
    """
    request = Request(**words["export"])
    return run_command(
        lambda: run(request, words["json"], words["quiet"], words["verbose"]),
        needs=f"export: --format {request.format}",
        install=words["install"],
        target=request.out,
        interrupted=lambda: "",
    )


if __name__ == "__main__":
    sys.exit(main(read_request()))
