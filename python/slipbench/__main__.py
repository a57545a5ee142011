"""The program `slipbench`, as a module and as the command that `pip install` creates."""

import os
import sys

from slipbench.bin import _core


def main() -> int:
    """Runs the command line with this process's arguments; returns its exit status."""
    os.environ.setdefault(
        "SLIPBENCH", f"{sys.executable} -m slipbench"
    )  # command with which the scripts of `cluster` start it
    os.environ.setdefault(
        "SLIPBENCH_PYTHON", sys.executable
    )  # interpreter for commands that are implemented in Python
    return _core.main(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
